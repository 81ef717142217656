#pragma once
// What cells have of their own follows, as a step begins, from what their bodies have lost.
//
// It is made for the cells of a tile where that is listed, or of a row where its gap is made, and nowhere
// else.
#include "running_in/film.h"
#include "properties.h"
#include "running_in/recession.h"

// 1/c of cells that do not yield [N/mm³].
static const double RIGID = 1.0e300;

// 1/c of cells in an implicit step: their own compliance and the wear of both bodies. A curve without a scale
// bears everywhere.
template <typename Slide, typename Sources, typename Properties>
WARPWEAR_FN void stiffen(const Slide& slide, const Sources& sources, const Properties& cells, int row,
                         int under, const Span& span)
{
    Stored* const stiffness = row_of(cells.stiffness, row);
    const CellRow own(cells, row);
    const auto& curve = sources.curve;
    const Stored* const wear = curve.scale > 0.0 ? row_of(sources.wear_disc, under) : nullptr;
    const Lanes one = 1.0, rigid = RIGID;
    for (int i = span.first; i < span.end; i += span.stride) {
        const Lanes compliance = slide.own + slide.removal.k_counter * own_or(own.k_counter, i, one);
        const Lanes k_disc = slide.removal.k_disc * own_or(own.k_disc, i, one);
        if (wear) {
            const Lanes ratio = each_lane([&](double v) { return bearing_ratio(v, curve); }, Lanes(wear[i]));
            stiffness[i] = one / (compliance + k_disc / ratio);
        } else {
            stiffness[i] = smaller_of(one / (k_disc + compliance), rigid);
        }
    }
}

// K and the cap of the materials that meet, and the compliance by them beside that of all. Of a body that
// wears by a mean of pressures all cells lend it alike.
template <typename Slide, typename Sources, typename Properties>
WARPWEAR_FN void look_at_materials(const Slide& slide, const Sources& sources, const Properties& cells,
                                   int row, int under, const Span& span)
{
    const CellRow own(cells, row);
    const Stored* const counter = row_of(sources.wear_counter, row);
    const Stored* const disc = row_of(sources.wear_disc, under);
    Stored *const k_counter = (Stored*)own.k_counter, *const k_disc = (Stored*)own.k_disc;
    Stored* const cap_ratio = (Stored*)own.cap_ratio;
    Stored* const yields = (Stored*)row_or_none(cells.yields, row);
    const bool by_place = slide.window == 1, turned = slide.counter_moves == 1;
    const double of_counter = by_place || turned ? slide.removal.k_counter : 0.0;
    const double of_disc = by_place || !turned ? slide.removal.k_disc : 0.0;
    const Lanes none = NO_LIMIT, one = 1.0;
    for (int i = span.first; i < span.end; i += span.stride) {
        if (k_counter) k_counter[i] = own.counter.number_at(RATIO, counter[i]);
        if (k_disc) k_disc[i] = own.disc.number_at(RATIO, disc[i]);
        if (yields)
            yields[i] =
                of_counter * own_or(k_counter, i, one) + of_disc * own_or(k_disc, i, one) - slide.compliance;
        if (!cap_ratio) continue;
        const Lanes cap = own.counter.count > 0 ? own.counter.number_at(CAP, counter[i]) : none;
        cap_ratio[i] = smaller_of(cap, own.disc.count > 0 ? own.disc.number_at(CAP, disc[i]) : none);
    }
}

// Make what cells of a row have of their own. What two sources set is multiplied here.
template <typename Slide, typename Sources, typename Properties>
WARPWEAR_FN void make_cells(const Slide& slide, const Sources& sources, const Properties& cells, int row,
                            int under, const Span& span)
{
    if (cells.material.shape[0] > 0) update_film(slide, sources.films, cells, row, under, span);
    if (sources.layered == 1) look_at_materials(slide, sources, cells, row, under, span);
    if (sources.stiffens == 1) stiffen(slide, sources, cells, row, under, span);
}

// Whether there is anything to make.
template <typename Sources, typename Properties>
WARPWEAR_FN bool makes(const Sources& sources, const Properties& cells)
{ return cells.material.shape[0] > 0 || sources.layered == 1 || sources.stiffens == 1; }

// The disc's row under a row of the contact; 0 where none moves.
template <typename Slide, typename Sources>
WARPWEAR_FN int row_beneath(int row, const Slide& slide, const Sources& sources)
{ return sources.disc_rows > 0 ? under_row(row, slide.shift, sources.disc_rows) : 0; }

// See of all cells which are bare.
template <typename Slides, typename Sources, typename Properties>
WARPWEAR_FN void look_at_rows(int slot, int slots, const Slides& slides, const Sources& sources,
                              const Properties& cells)
{
    const auto& slide = wp::index(slides, 0);
    const Span span = {lane_of_slot(), cells.material.shape[1] * OF_VECTOR, width_of_slot()};
    for (int row = slot; row < cells.material.shape[0]; row += slots)
        update_film(slide, sources.films, cells, row, row_beneath(row, slide, sources), span);
}

// Make the stiffness of all cells, or of one row that serves all.
template <typename Slides, typename Sources, typename Properties>
WARPWEAR_FN void stiffen_rows(int slot, int slots, const Slides& slides, const Sources& sources,
                              const Properties& cells)
{
    const auto& slide = wp::index(slides, 0);
    const Span span = {lane_of_slot(), cells.stiffness.shape[1] * OF_VECTOR, width_of_slot()};
    for (int row = slot; row < cells.stiffness.shape[0]; row += slots)
        stiffen(slide, sources, cells, row, row_beneath(row, slide, sources), span);
}

// Make what the cells of the tiles listed have of their own, where a list serves several steps.
template <typename List, typename Count, typename Slides, typename Sources, typename Properties>
WARPWEAR_FN void make_listed(int slot, int slots, const List& list, const Count& counts, const Slides& slides,
                             const Sources& sources, const Properties& cells)
{
    const auto& slide = wp::index(slides, 0);
    const auto& any = cells.material.shape[0] > 0 ? cells.material : cells.stiffness;
    const int vectors_per_row = any.shape[1] * OF_VECTOR;
    for (int row = slot; row < any.shape[0]; row += slots)
        for (int n = team_of_slot(); n < wp::index(counts, row); n += teams_of_slot())
            make_cells(slide, sources, cells, row, row_beneath(row, slide, sources),
                       span_of_tile(wp::index(list, row, n), vectors_per_row));
}

// Note the distance at the end of a step where the bodies under the tiles listed were worn in it.
template <typename List, typename Count, typename Slides, typename Sources>
WARPWEAR_FN void rub_listed(int slot, int slots, const List& list, const Count& counts, const Slides& slides,
                            const Sources& sources)
{
    const auto& slide = wp::index(slides, 0);
    const auto& films = sources.films;
    const int vectors_per_row =
        (films.counter.seen.shape[0] > 0 ? films.counter : films.disc).seen.shape[1] * OF_VECTOR;
    for (int row = slot; row < counts.shape[0]; row += slots)
        for (int n = team_of_slot(); n < wp::index(counts, row); n += teams_of_slot())
            record_wear(slide, films, row, row_beneath(row, slide, sources),
                        span_of_tile(wp::index(list, row, n), vectors_per_row));
}

// The same of the columns ever touched, where more is worn than what is listed.
template <typename Slides, typename Sources>
WARPWEAR_FN void rub_rows(int slot, int slots, const Slides& slides, const Sources& sources, int rows)
{
    const auto& slide = wp::index(slides, 0);
    const Span span = {slide.first_column / 8 * OF_VECTOR + lane_of_slot(),
                       (slide.end_column + 7) / 8 * OF_VECTOR, width_of_slot()};
    for (int row = slot; row < rows; row += slots)
        record_wear(slide, sources.films, row, row_beneath(row, slide, sources), span);
}
