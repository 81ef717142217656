#pragma once
// What cells have of their own, and the depths that a step wears off both of their bodies.
//
// Every pass that wears goes by `removal_of`, as every pass over springs goes by `on_spring`. A law of wear
// that differs from cell to cell is told here and nowhere else.
#include "law.h"
#include "layers.h"

// The depth that a pressure wears off a body whose cells are alike [mm]. k: K ΔL [mm³/N].
template <typename Real> WARPWEAR_FN Real removal_of(double k, Real p)
{
    CONTRACT_FAST
    return k * p;
}

// What a cell has of its own, or what all have.
WARPWEAR_FN Lanes own_or(const Stored* own, int i, Lanes alike) { return own ? (Lanes)own[i] : alike; }

// What the cells of a row have of their own, see `CellProperties`.
struct CellRow {
    const Stored *stiffness, *cap_ratio, *shear_ratio, *k_counter, *k_disc, *material;
    Materials counter, disc;

    template <typename Properties>
    CUDA_CALLABLE CellRow(const Properties& cells, int row)
        : stiffness(row_or_none(cells.stiffness, row)), cap_ratio(row_or_none(cells.cap_ratio, row)),
          shear_ratio(row_or_none(cells.shear_ratio, row)), k_counter(row_or_none(cells.k_counter, row)),
          k_disc(row_or_none(cells.k_disc, row)), material(row_or_none(cells.material, row)),
          counter(cells.materials_counter), disc(cells.materials_disc)
    {
    }

    // Whether cells wear, bear or are counted by anything of their own.
    CUDA_CALLABLE bool has_own() const
    { return cap_ratio || k_counter || k_disc || material || counter.count > 0 || disc.count > 0; }
};

// What bears a cell: its own stiffness, or what all have alike.
template <bool OWN> WARPWEAR_FN Lanes spring_at(const Stored* own, int i, Lanes alike)
{ return OWN ? own_or(own, i, alike) : alike; }
template <bool> WARPWEAR_FN const Bend& spring_at(const Stored*, int, const Bend& alike) { return alike; }

// A number of each body.
struct PerBody {
    Lanes counter, disc;
};

// The pressure of a cell over which both bodies wear by K of the step: its own, or where K goes with it, that
// times K over that of the step.
WARPWEAR_FN PerBody wearing_pressure(Lanes, Lanes p) { return {p, p}; }
WARPWEAR_FN PerBody wearing_pressure(const Bend& bend, Lanes p)
{ return {bend.k_at(0, p) * p, bend.k_at(1, p) * p}; }

// K of the disc over that of the step, where cells may have one each; RARE: all may be alike in it.
template <bool RARE> WARPWEAR_FN Lanes k_disc_at(const CellRow& cells, int i)
{ return RARE ? own_or(cells.k_disc, i, 1.0) : (Lanes)cells.k_disc[i]; }

// The depths that a step wears off both bodies of cells [mm]: K ΔL p, and what their shear wears. pressure:
// that which wears each body, as it sees it. worn: what they have lost before, through whose materials they
// wear. sheared: part of the step in contact times the shear ratio. OWN: whether the disc's cells have a K
// each; RARE: whether those of both have materials or a K each, or shear wears. Nothing of it is fused with
// what it is added to.
template <bool OWN, bool RARE, typename Removal>
WARPWEAR_FN PerBody removal_of(const Removal& step, const CellRow& cells, int i, const PerBody& pressure,
                               const PerBody& worn, const PerBody& sheared)
{
    CONTRACT_OFF
    const Lanes one = 1.0;
    const Lanes k_counter = OWN && RARE ? own_or(cells.k_counter, i, one) : one;
    const Lanes k_disc = OWN ? k_disc_at<RARE>(cells, i) : one;
    PerBody depth = {step.k_counter * k_counter * pressure.counter, step.k_disc * k_disc * pressure.disc};
    if (OWN && RARE && cells.counter.count > 0)
        depth.counter = lost_from_each(cells.counter, worn.counter, step.k_counter * pressure.counter);
    if (OWN && RARE && cells.disc.count > 0)
        depth.disc = lost_from_each(cells.disc, worn.disc, step.k_disc * pressure.disc);
    if (RARE) {
        depth.counter += step.shear_counter * sheared.counter;
        depth.disc += step.shear_disc * sheared.disc;
    }
    return depth;
}
