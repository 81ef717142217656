"use strict";
// Draws the plots of a page. All that it needs lies in the page, compressed; nothing is requested.
(async () => {
  const root = document.documentElement, $ = (id) => document.getElementById(id);
  const all = (query, inside = document) => [...inside.querySelectorAll(query)];
  const bytesOf = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
  const unpacked = async (id, kind) => {
    const stream = new Blob([bytesOf($(id).textContent)]).stream();
    return new Response(stream.pipeThrough(new DecompressionStream(kind))).text();
  };

  let data;
  try {
    data = JSON.parse(await unpacked("data", "deflate"));
    const library = document.createElement("script");
    library.textContent = await unpacked("plotly", "gzip");
    document.head.append(library);
  } catch (error) {
    $("too-old").hidden = false;
    return;
  }
  root.classList.add("scripted");

  // ---- arrays -------------------------------------------------------------------------------------
  const TYPES = { u1: Uint8Array, u2: Uint16Array, f4: Float32Array };
  const arrayOf = (packed) => new TYPES[packed.type](bytesOf(packed.data).buffer);
  const rowsOf = (values, [nx, ny]) => Array.from({ length: ny }, (_, j) => values.subarray(j * nx, (j + 1) * nx));
  // Values of codes, NaN for 0; logarithms stay logarithms.
  const decoded = (coded) => {
    const values = Float32Array.from(arrayOf(coded.codes), (c) => (c ? coded.low + coded.step * c : NaN));
    return rowsOf(values, coded.codes.shape);
  };
  const places = (first, last, count) =>
    Float64Array.from({ length: count }, (_, i) => first + ((i + 0.5) * (last - first)) / count);

  // ---- looks --------------------------------------------------------------------------------------
  const media = { dark: matchMedia("(prefers-color-scheme: dark)"), print: matchMedia("print") };
  let chosen = null; // the reader's own choice of dark or light
  let printing = false;
  const isPrint = () => printing || media.print.matches;
  // A page is laid out for paper after plots are drawn for it: A4 and Letter both hold these widths.
  const widthOf = (node) => {
    if (!isPrint()) return node.parentElement.clientWidth;
    return node.closest(".plots").classList.contains("single") ? 670 : 330;
  };
  const isDark = () => !isPrint() && (chosen ?? media.dark.matches);
  const ink = (name) => getComputedStyle(root).getPropertyValue(`--${name}`).trim();
  // On dark paper a dark colour is mixed with white.
  const lifted = (hex) => {
    const parts = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
    if (!isDark() || 0.3 * parts[0] + 0.6 * parts[1] + 0.1 * parts[2] > 120) return hex;
    return `#${parts.map((v) => Math.round(v + 0.4 * (255 - v)).toString(16).padStart(2, "0")).join("")}`;
  };
  const colour = (name) => (name.startsWith("#") ? lifted(name) : ink(name));
  // Names are anyone's: no tag of the plotting library's, and not longer than a legend bears.
  const plain = (text, most = 48) => (text.length > most ? `${text.slice(0, most - 1)}…` : text)
    .replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
  // Little pressure is near the paper's own lightness.
  const pressures = () => (isDark() ? [...data.scales.pressures].reverse().slice(2) : data.scales.pressures);
  const scaleOf = (colours) => colours.map((c, i) => [i / (colours.length - 1), c]);
  const axis = (title, more = {}) => ({
    title: { text: title, standoff: 8 }, gridcolor: ink("grid"), linecolor: ink("soft"), zeroline: false, showline: true,
    ticks: "outside", tickcolor: ink("soft"), automargin: true, exponentformat: "power", ...more,
  });
  const layout = (more) => ({
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", margin: { l: 60, r: 15, t: 10, b: 45 },
    font: { family: "system-ui, Segoe UI, Helvetica Neue, Arial, sans-serif", size: 13, color: ink("ink") },
    hoverlabel: { bgcolor: ink("card"), bordercolor: ink("soft"), font: { color: ink("ink") } }, ...more,
  });
  const CONFIG = { responsive: true, displaylogo: false, displayModeBar: false };

  // ---- charts -------------------------------------------------------------------------------------
  let linear = false;
  const lines = new Map(); // arrays are decoded once
  const pale = (name, part) => `rgba(${[1, 3, 5].map((i) => parseInt(colour(name).slice(i, i + 2), 16)).join()},${part})`;
  const logarithmic = (...arrays) => {
    const known = arrays.flatMap((array) => [...array].filter((v) => v > 0));
    const decades = Math.log10(Math.max(...known) / Math.min(...known));
    return { type: "log", exponentformat: "power", dtick: decades > 2.5 ? Math.ceil(decades / 7) : decades > 0.8 ? "D2" : "D1", tickformat: "~g" };
  };
  const chart = (plot, node) => {
    const optional = (packed) => (packed ? arrayOf(packed) : null);
    if (!lines.has(plot)) lines.set(plot, plot.lines.map((line) => [arrayOf(line.x), arrayOf(line.y), optional(line.low), optional(line.high)]));
    const arrays = lines.get(plot), logX = plot.log_x && !linear, logY = plot.log_y && !linear;
    const many = plot.lines.length > 8;
    const shownOf = (values) => (logY ? values.map((v) => (v > 0 ? v : NaN)) : values);
    const traces = plot.lines.flatMap((line, i) => {
      const [x, y, low, high] = arrays[i], common = { type: "scatter", x, legendgroup: String(i) };
      const trace = {
        ...common, y: shownOf(y), mode: line.marks, name: plain(line.name), opacity: line.opacity, showlegend: line.named && !plot.bare,
        line: { color: colour(line.colour), dash: line.dash, width: line.width, shape: line.shape },
        text: [plain(line.name)], marker: { color: colour(line.colour), symbol: line.symbol, size: line.marks === "markers" ? 7 : 6, opacity: line.marks === "markers" ? 0.7 : 1 },
        hovertemplate: many || line.marks === "markers" ? `${plain(line.name)}<br>%{x:.4~g}: %{y:.4~g}<extra></extra>` : "%{y:.4~g}",
      };
      if (!low) return [trace];
      const edge = { ...common, mode: "lines", line: { width: 0 }, showlegend: false, hoverinfo: "skip" };
      const isBand = line.marks === "none", band = { ...edge, y: shownOf(high), fill: "tonexty", fillcolor: pale(line.colour, isBand ? line.opacity : 0.2) };
      return [{ ...edge, y: shownOf(low) }, ...(isBand ? [{ ...band, name: trace.name, showlegend: trace.showlegend }] : [band, trace])];
    });
    const least = arrays.every(([, y]) => y.every((v) => !(v < 0)));
    const named = plot.lines.filter((line) => line.named);
    const longest = Math.max(1, ...named.map((line) => Math.min(48, line.name.length)));
    const beside = Math.max(1, Math.floor((widthOf(node) - 80) / (7 * longest + 50)));
    const rows = plot.bare ? 0 : Math.ceil(named.length / beside);
    node.style.height = `${21 + 1.25 * Math.max(0, rows - 2)}rem`;
    return [traces, layout({
      hovermode: many || plot.lines.some((line) => line.marks === "markers") ? "closest" : "x unified", showlegend: named.length > 0 && !plot.bare,
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: { size: 12 }, maxheight: 0.6 },
      margin: { l: 65, r: 15, t: 10, b: 45 },
      xaxis: axis(plain(plot.x, 80), { ...(logX ? logarithmic(...arrays.map(([x]) => x)) : {}), hoverformat: ".5~g" }),
      yaxis: axis(plain(plot.y, 80), logY ? logarithmic(...arrays.map(([, y]) => y)) : { rangemode: least ? "tozero" : "normal" }),
    })];
  };

  // ---- bars and grids -----------------------------------------------------------------------------
  const bars = (plot, node) => {
    const values = arrayOf(plot.values), places = [...values].map((_, i) => -i), names = plot.names.map((name) => plain(name, 60));
    node.style.height = `${2.4 * names.length + 5}rem`;
    const traces = [{
      type: "bar", orientation: "h", x: values, y: places, marker: { color: data.scales.heights[4] }, width: 0.6, showlegend: false,
      customdata: names, hovertemplate: "%{customdata}: %{x:.3~g}<extra></extra>",
    }];
    if (plot.ends) {
      const { shape: [count] } = plot.values, ends = arrayOf(plot.ends);  // x fastest: low and high of each name
      const side = (k) => places.map((_, i) => Math.abs(ends[2 * i + k] - values[i]) || 0);
      if (count) Object.assign(traces[0], { error_x: { type: "data", symmetric: false, arrayminus: side(0), array: side(1), color: ink("ink"), thickness: 1.5 } });
    }
    if (plot.dots) traces.push({
      type: "scatter", mode: "markers", x: arrayOf(plot.dots), y: places, marker: { color: "#E69F00", size: 10, line: { color: ink("ink"), width: 1 } },
      showlegend: false, hovertemplate: "first order: %{x:.3~g}<extra></extra>",
    });
    return [traces, layout({
      margin: { l: 60, r: 15, t: 10, b: 45 }, xaxis: axis(plot.x, { range: plot.limits, zeroline: true, zerolinecolor: ink("soft") }),
      yaxis: axis("", { tickvals: places, ticktext: names, showgrid: false }),
    })];
  };
  const grid = (plot, node) => {
    const rows = rowsOf(arrayOf(plot.values), plot.values.shape), label = (v) => (v === v ? String(+v.toPrecision(3)) : "–");
    node.style.height = `${Math.min(40, 2.6 * rows.length + 7)}rem`;
    const few = rows.length <= 12 && rows[0].length <= 12, ticks = (names) => ({ type: "category", tickvals: names.map((_, i) => i), ticktext: names.map((n) => plain(n, 30)), showgrid: false });
    const trace = {
      type: "heatmap", z: rows, x: plot.across.map((_, i) => i), y: plot.down.map((_, i) => i), colorscale: scaleOf(data.scales.heights), xgap: 2, ygap: 2,
      text: rows.map((row) => [...row].map(label)), texttemplate: few ? "%{text}" : "", hovertemplate: "%{text}<extra></extra>", hoverongaps: false,
      colorbar: { thickness: 12 },
    };
    const at = (title, names) => axis(plain(title, 60), { ...ticks(names), type: "linear" });
    return [[trace], layout({ margin: { l: 60, r: 15, t: 10, b: 45 }, xaxis: at(plot.x, plot.across), yaxis: at(plot.y, plot.down) })];
  };

  // ---- maps over the snapshots --------------------------------------------------------------------
  const shown = new Map(); // plot -> number of its snapshot
  const map = (plot) => {
    const number = shown.get(plot) ?? plot.fields.length - 1, field = plot.fields[number];
    const [nx, ny] = field.codes.shape, [x0, x1, y0, y1] = plot.extent;
    const [dx, dy] = [(x1 - x0) / nx, (y1 - y0) / ny];  // of one row too, of which a list of places tells none
    const common = { type: "heatmap", x0: x0 + 0.5 * dx, dx, y0: y0 + 0.5 * dy, dy, hoverongaps: false };
    let trace;
    if (plot.states.length) {
      const count = plot.states.length;
      const steps = plot.states.flatMap(([, c], i) => [[i / count, colour(c)], [(i + 1) / count, colour(c)]]);
      trace = {
        ...common, z: rowsOf(arrayOf(field.codes), field.codes.shape), colorscale: steps,
        zmin: -0.5, zmax: count - 0.5, zsmooth: false,
        hovertemplate: "%{x:.4~g}, %{y:.4~g} mm<extra></extra>",
        colorbar: { thickness: 12, len: 1, tickfont: { size: 11 },
          tickvals: plot.states.map((_, i) => i), ticktext: plot.states.map(([label]) => label.replace(" ", "<br>")) },
      };
    } else {
      const values = decoded(field), of = plot.fields.map((f) => [f.low + f.step, f.low + 255 * f.step]);
      const low = Math.min(...of.map(([v]) => v)), high = Math.max(...of.map(([, v]) => v));
      const ticks = [];
      if (field.log) for (let p = Math.floor(low); p <= high; p += 1)
        for (const digit of high - low > 2 ? [1] : [1, 2, 5]) {
          const at = p + Math.log10(digit);
          if (at >= low && at <= high) ticks.push([at, `${+(10 ** at).toPrecision(1)}`]);
        }
      trace = {
        ...common, z: values, customdata: field.log ? values.map((row) => row.map((v) => 10 ** v)) : values,
        colorscale: scaleOf(plot.colours === "pressures" ? pressures() : data.scales[plot.colours]), zmin: low, zmax: high,
        hovertemplate: `%{customdata:.3~g} ${plot.unit}<br>%{x:.4~g}, %{y:.4~g} mm<extra></extra>`,
        colorbar: { thickness: 12, len: 1, tickfont: { size: 11 }, title: { text: plot.unit, side: "right", font: { size: 12 } },
          ...(ticks.length ? { tickvals: ticks.map(([at]) => at), ticktext: ticks.map(([, text]) => text) } : {}) },
      };
    }
    return [[trace], layout({
      margin: { l: 60, r: 15, t: 10, b: 45 },
      xaxis: axis("along sliding, mm", { constrain: "domain", showgrid: false }),
      yaxis: plot.long ? axis("across, mm (drawn larger)", { showgrid: false }) : axis("across, mm", { scaleanchor: "x", constrain: "domain", showgrid: false }),
    })];
  };

  // ---- bodies in 3-D ------------------------------------------------------------------------------
  const NARROW = innerWidth < 640;
  const START = { turn: -0.25 * Math.PI, tilt: 0.6, far: NARROW ? 2.6 : 1.7 };
  const camera = { ...START };
  const eye = () => ({
    x: camera.far * Math.cos(camera.tilt) * Math.cos(camera.turn),
    y: camera.far * Math.cos(camera.tilt) * Math.sin(camera.turn), z: camera.far * Math.sin(camera.tilt),
  });
  let body = 0;
  const bodies = (plot) => {
    const coded = Object.values(plot.bodies)[body], [nx, ny] = coded.codes.shape, [x0, x1, y0, y1] = plot.extent;
    const axis3 = (title) => ({ title: { text: title, font: { size: 12 } }, gridcolor: ink("grid"), color: ink("ink"), showbackground: false, ...(NARROW ? { nticks: 4, tickfont: { size: 10 } } : {}) });
    const trace = {
      type: "surface", x: places(x0, x1, nx), y: places(y0, y1, ny), z: decoded(coded), colorscale: scaleOf(data.scales.heights),
      // On a narrow page it lies below: beside the bodies it would cost the labels of their heights their room.
      colorbar: NARROW ? { title: { text: "height, µm", side: "top" }, thickness: 12, orientation: "h", y: -0.02, yanchor: "top" }
        : { title: { text: "height, µm", side: "right" }, thickness: 12, len: 0.7 },
      hovertemplate: "%{z:.4~g} µm<br>%{x:.4~g}, %{y:.4~g} mm<extra></extra>",
    };
    return [[trace], layout({
      margin: { l: 0, r: 0, t: 0, b: NARROW ? 60 : 0 },
      scene: { xaxis: axis3("along, mm"), yaxis: axis3("across, mm"), zaxis: axis3("height, µm"),
        aspectmode: "manual", aspectratio: { x: 1, y: (y1 - y0) / (x1 - x0), z: 0.45 }, camera: { eye: eye() } },
    })];
  };
  const canvas = document.createElement("canvas");
  const hasWebGL = Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));

  // ---- all of them --------------------------------------------------------------------------------
  const KINDS = { chart, map, bodies, bars, grid };
  const plotOf = (node) => data.plots[Number(node.dataset.plot)];
  const draw = async (node) => {
    const plot = plotOf(node);
    if (plot.kind === "bodies" && !hasWebGL) return;
    node.classList.add("drawn");
    const [traces, looks] = KINDS[plot.kind](plot, node);
    if (isPrint()) Object.assign(looks, { autosize: false, width: widthOf(node), height: node.offsetHeight || 336 });
    await Plotly.react(node, traces, looks, CONFIG);
    if (plot.kind === "bodies" && !node.dataset.turned) {
      node.dataset.turned = "0";
      node.on("plotly_relayout", (change) => {
        const at = (change["scene.camera"] ?? {}).eye;
        if (!at) return;
        camera.far = Math.hypot(at.x, at.y, at.z);
        [camera.tilt, camera.turn] = [Math.asin(at.z / camera.far), Math.atan2(at.y, at.x)];
        node.dataset.turned = String(Number(node.dataset.turned) + 1);
      });
    }
  };
  const nodes = all(".plot");
  const drawAll = async () => {
    root.classList.toggle("dark", isDark());
    $("theme").textContent = isDark() ? "Light" : "Dark";
    $("theme").setAttribute("aria-pressed", String(isDark()));
    for (const line of all("[data-colour]")) line.setAttribute("stroke", colour(line.dataset.colour));
    await Promise.all(nodes.map(draw)); // all begin at once: paper does not wait
  };

  for (const slider of all(".slider")) {
    const section = slider.closest("section"), maps = all(".plot.map", section);
    slider.addEventListener("input", () => {
      const number = Number(slider.value), { labels } = plotOf(maps[0]);
      slider.setAttribute("aria-valuetext", labels[number]);
      slider.parentElement.querySelector("output").textContent = labels[number];
      for (const node of maps) {
        shown.set(plotOf(node), number);
        draw(node);
        const says = node.parentElement.querySelector(".says-now");
        if (says) says.textContent = plotOf(node).says[number];
      }
    });
  }
  $("linear")?.addEventListener("click", () => {
    linear = !linear;
    $("linear").setAttribute("aria-pressed", String(linear));
    for (const node of all("#courses .plot")) draw(node);
  });
  all("#choose-body button").forEach((button, number, buttons) => button.addEventListener("click", () => {
    body = number;
    buttons.forEach((other, i) => other.setAttribute("aria-pressed", String(i === number)));
    for (const node of all(".plot.bodies")) draw(node);
  }));
  const TURNS = {
    ArrowLeft: () => { camera.turn -= 0.1; }, ArrowRight: () => { camera.turn += 0.1; },
    ArrowUp: () => { camera.tilt = Math.min(camera.tilt + 0.1, 1.5); },
    ArrowDown: () => { camera.tilt = Math.max(camera.tilt - 0.1, -1.5); },
    "+": () => { camera.far *= 0.9; }, "-": () => { camera.far /= 0.9; }, Home: () => { Object.assign(camera, START); },
  };
  for (const node of all(".plot.bodies")) node.addEventListener("keydown", (event) => {
    if (!TURNS[event.key]) return;
    event.preventDefault();
    TURNS[event.key]();
    Plotly.relayout(node, { "scene.camera": { eye: eye() } });
  });
  for (const button of all("button.copy")) button.addEventListener("click", async () => {
    const text = $(button.dataset.copy).textContent, before = button.textContent;
    try {
      await navigator.clipboard.writeText(text);
    } catch (error) { // a page from a disk may not be allowed to
      const field = document.createElement("textarea");
      field.value = text;
      document.body.append(field);
      field.select();
      document.execCommand("copy");
      field.remove();
      button.focus();
    }
    button.textContent = "Copied";
    setTimeout(() => { button.textContent = before; }, 1500);
  });
  $("theme").addEventListener("click", () => { chosen = !isDark(); drawAll(); });
  for (const query of Object.values(media)) query.addEventListener("change", drawAll);
  addEventListener("beforeprint", () => { printing = true; drawAll(); });
  addEventListener("afterprint", () => { printing = false; drawAll(); });
  await drawAll();
  root.dataset.ready = "true"; // for who waits for it
})();
