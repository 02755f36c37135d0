/* Charts of railhil: a thin layer over uPlot, for report.html and for the live panel. Plain arrays in, nothing fetched.

   railhilCharts.chart(parent, description, data)   curves                        -> handle
   railhilCharts.tracks(parent, description, data)  levels over x, as bands       -> handle
   railhilCharts.join([[x, y, ...], ...])           data of several x, as uPlot.join
   railhilCharts.setTheme("dark" | "light" | "")    ""; what the system asks for; redraws all charts
   railhilCharts.colour(name)                       CSS colour of "0".."6", "target", "ink", "dim", "fault" ...
   railhilCharts.shown(number)                      a number as the legend writes it: 7 significant digits

   description: {
     title, unit,                    above the chart: "title (unit)"; both may be empty
     x: {label, unit, range},        of the horizontal axis; range: [low, high] without a zoom, otherwise that of the data
     lines: [{at, name}],            named lines across the chart, x ascending; a name without room is left out
     series: [{label, unit, colour, dash, width, step, show, names, within, end, filled}]
                                     colour: place in the palette or "target"; dash: in px; step: hold each value until the next;
                                     names: words for the values 0, 1, 2 ... (a level, a flag)
                                     within: how far at most the curve is from the line between two of its points
                                     end: word at the last value; filled: the area to 0
     height,                         px of the drawing, without title and legend; "fill": what the parent has left
     sync,                           charts with the same word share cursor and zoom
     y: [low, high],                 fixed scale: cheaper, for streams
     markers: [{at, until, text, fault}]   events: instants, or spans if until is given
   }
   data: [x, y, y, ...], arrays or typed arrays of one length; x ascending; null, undefined or NaN: no value.
   tracks(): as chart(), each series is one row; its values are levels, 0 is normal (not painted), series.names their words.

   handle: {
     setData(data),                  new values; a zoom of the reader stays
     setMarkers(markers),
     setPlaces([x, ...]),            triangles below the chart's curves: where something is now
     show(place, on),                one series, counted from 0
     zoom(low, high), zoom(),        range of x of the chart and those of its sync word; without figures: everything
     range(), zoomed(),              [low, high] as shown; whether that is less than everything
     cursor(x),                      puts the cursor at x, as hovering does; null: away
     destroy(), element, plot        plot: the uPlot
   }
   Mouse: drag to zoom, double click for everything, ctrl and wheel. Touch: two fingers. Keys on a focused chart: + - 0,
   left and right move the cursor, with shift the view. */
"use strict";
const railhilCharts = (() => {
  const FONT = "12px system-ui, sans-serif", AXIS_PX = 56, NEAR_PX = 6, ROW_PX = 38, AXES_PX = 62, HEIGHT_MIN_PX = 80;
  const every = new Set();
  const dark = matchMedia("(prefers-color-scheme: dark)");

  const colour = name => getComputedStyle(document.documentElement).getPropertyValue(`--rc-${name}`).trim();
  const shown = value => value == null || Number.isNaN(value) ? "-" : String(Number(value.toPrecision(7)));
  const group = chart => chart.sync ? [...every].filter(other => other.sync === chart.sync) : [chart];

  // A chart without a value has no axes yet.
  function redraw(chart) { if (chart.plot.scales.x.min != null) chart.plot.redraw(false); }
  function redrawAll() { for (const chart of every) redraw(chart); }
  dark.addEventListener("change", redrawAll);
  function setTheme(name) {
    if (name) document.documentElement.dataset.theme = name;
    else delete document.documentElement.dataset.theme;
    redrawAll();
  }

  // uPlot's gaps are null; a typed array cannot hold it.
  function withGaps(values) {
    if (!ArrayBuffer.isView(values)) return values;
    for (let i = 0; i < values.length; i++)
      if (Number.isNaN(values[i])) return Array.from(values, value => Number.isNaN(value) ? null : value);
    return values;
  }

  // The place whose value holds at the cursor: the nearest one for curves, the last one for levels.
  function place(plot, series, nearest, x) {
    const xs = plot.data[0], ys = plot.data[series], last = plot.series[series].rcStep;
    let low = nearest;
    if (last) while (low > 0 && xs[low] > x) low--;
    if (ys[low] !== undefined) return low;
    let high = low;
    while (low >= 0 && ys[low] === undefined) low--;
    while (high < ys.length && ys[high] === undefined) high++;
    if (low < 0) return last || high === ys.length ? nearest : high;
    return last || high === ys.length || x - xs[low] <= xs[high] - x ? low : high;
  }

  // Between two points of a curve whose neighbour has one here: on the line between them; null where there is none.
  function onLine(plot, series, at) {
    const xs = plot.data[0], ys = plot.data[series];
    let low = at, high = at;
    while (low >= 0 && ys[low] === undefined) low--;
    while (high < ys.length && ys[high] === undefined) high++;
    if (low < 0 || high === ys.length || ys[low] == null || ys[high] == null) return null;
    return ys[low] + (ys[high] - ys[low]) * (xs[at] - xs[low]) / (xs[high] - xs[low]);
  }

  // A value as the legend writes it; one that is not a point of the curve is marked.
  function legend(item, holds, plot, value, series, index) {
    const at = plot.cursor.idx, unit = item.unit ? ` ${item.unit}` : "";
    if (index == null || value == null || Number.isNaN(value)) return "-";
    if (item.names?.[value] !== undefined) return item.names[value] + unit;
    if (holds || at == null || plot.data[series][at] !== undefined) return shown(value) + unit;
    const between = onLine(plot, series, at);
    const within = item.within ? ` ± ${Number(item.within.toPrecision(2))}` : "";
    return between == null ? "-" : `≈ ${Number(between.toPrecision(5))}${within}${unit}`;
  }

  function digits(plot, splits, axis, space, step) {
    let decimals = 0;
    while (decimals < 9 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6) decimals++;
    return splits.map(value => value == null ? "" : value.toFixed(decimals));
  }

  function drawMarkers(chart) {
    const {plot, markers} = chart, {ctx, bbox} = plot, ratio = devicePixelRatio;
    ctx.save();
    ctx.beginPath(); ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height); ctx.clip();
    let before = -Infinity;
    for (const marker of markers) {
      const x = plot.valToPos(marker.at, "x", true);
      // Instants closer than can be told apart would hide the curves.
      if (!marker.fault && marker.until === undefined && Math.abs(x - before) < 4 * ratio) continue;
      before = x;
      ctx.strokeStyle = ctx.fillStyle = colour(marker.fault ? "fault" : "dim");
      if (marker.until > marker.at) {
        ctx.globalAlpha = marker.fault ? .16 : .08;
        ctx.fillRect(x, bbox.top, plot.valToPos(marker.until, "x", true) - x, bbox.height);
        ctx.globalAlpha = 1;
      }
      ctx.lineWidth = (marker.fault ? 2 : 1) * ratio;
      ctx.setLineDash(marker.fault ? [] : [3 * ratio, 3 * ratio]);
      ctx.beginPath(); ctx.moveTo(x, bbox.top); ctx.lineTo(x, bbox.top + bbox.height); ctx.stroke();
      ctx.beginPath();
      ctx.moveTo(x - 5 * ratio, bbox.top); ctx.lineTo(x + 5 * ratio, bbox.top); ctx.lineTo(x, bbox.top + 7 * ratio);
      ctx.fill();
    }
    ctx.restore();
  }

  // Named lines from top to bottom, the names along them; then the places.
  function drawLines(chart) {
    const {plot, lines, places} = chart, {ctx, bbox} = plot, ratio = devicePixelRatio;
    ctx.save();
    ctx.beginPath(); ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height); ctx.clip();
    ctx.font = `${12 * ratio}px system-ui, sans-serif`;
    ctx.textAlign = "right";
    let before = -Infinity;
    for (const {at, name} of lines) {
      const x = plot.valToPos(at, "x", true), room = x - before >= 13 * ratio, first = x - bbox.left < 14 * ratio;
      ctx.strokeStyle = ctx.fillStyle = colour("dim");
      ctx.lineWidth = ratio;
      ctx.setLineDash([2 * ratio, 2 * ratio]);
      ctx.beginPath(); ctx.moveTo(x, bbox.top); ctx.lineTo(x, bbox.top + bbox.height); ctx.stroke();
      if (!room || x < bbox.left) continue;
      // Of the first one the name stands on the other side.
      before = first ? x + 17 * ratio : x;
      ctx.save();
      ctx.translate(x, bbox.top);
      ctx.rotate(-Math.PI / 2);
      ctx.setLineDash([]);
      ctx.strokeStyle = colour("paper");
      ctx.lineWidth = 3 * ratio;
      ctx.lineJoin = "round";
      ctx.textBaseline = first ? "top" : "bottom";
      for (const draw of ["strokeText", "fillText"]) ctx[draw](name, -4 * ratio, (first ? 3 : -3) * ratio);
      ctx.restore();
    }
    ctx.fillStyle = colour("ink");
    for (const at of places) {
      const x = plot.valToPos(at, "x", true), low = bbox.top + bbox.height;
      ctx.beginPath();
      ctx.moveTo(x, low - 14 * ratio); ctx.lineTo(x - 7 * ratio, low); ctx.lineTo(x + 7 * ratio, low);
      ctx.fill();
    }
    ctx.restore();
  }

  // The words at the ends of the curves, apart from each other: a colour alone tells nobody which one it is.
  function drawEnds({plot}) {
    const {ctx, bbox} = plot, ratio = devicePixelRatio, {min, max} = plot.scales.x, xs = plot.data[0], room = 13 * ratio;
    const ends = plot.series.flatMap((series, number) => {
      if (!series.rcEnd || !series.show) return [];
      const ys = plot.data[number];
      let at = ys.length - 1;
      while (at >= 0 && (ys[at] == null || Number.isNaN(ys[at]) || xs[at] > max)) at--;
      return at < 0 || xs[at] < min ? [] : [{series, x: plot.valToPos(xs[at], "x", true), y: plot.valToPos(ys[at], "y", true)}];
    }).sort((one, other) => one.y - other.y);
    ctx.save();
    ctx.font = `600 ${12 * ratio}px system-ui, sans-serif`;
    ctx.textBaseline = "bottom";
    ctx.lineWidth = 3 * ratio;
    ctx.lineJoin = "round";
    ctx.strokeStyle = colour("paper");
    let above = bbox.top;
    // What is too low stands higher, and pushes the others up.
    const tops = ends.map(({y}) => (above = Math.max(above + room, y - 2 * ratio)));
    for (let at = tops.length - 1, low = bbox.top + bbox.height; at >= 0; at--, low -= room) tops[at] = low = Math.min(low, tops[at]);
    ends.forEach(({series, x}, at) => {
      const fits = x + 6 * ratio + ctx.measureText(series.rcEnd).width <= bbox.left + bbox.width;
      ctx.textAlign = fits ? "left" : "right";
      ctx.fillStyle = colour(series.rcColour);
      for (const draw of ["strokeText", "fillText"]) ctx[draw](series.rcEnd, fits ? x + 5 * ratio : bbox.left + bbox.width - 3 * ratio, tops[at]);
    });
    ctx.restore();
  }

  function tell(chart) {
    const {plot, markers, tip} = chart, left = plot.cursor.left;
    const near = left < 0 ? [] : markers.filter(marker => Math.abs(plot.valToPos(marker.at, "x") - left) <= NEAR_PX);
    // Of charts with a common cursor only the one that the reader is at speaks.
    tip.hidden = !near.length || !chart.element.matches(":hover, :focus");
    if (tip.hidden) return;
    tip.textContent = near.slice(0, 4).map(marker => marker.text).join("; ") + (near.length > 4 ? " ..." : "");
    const at = plot.bbox.left / devicePixelRatio + left, right = at > plot.width / 2;
    tip.style.left = right ? "auto" : `${at + 8}px`;
    tip.style.right = right ? `${plot.width - at + 8}px` : "auto";
    tip.style.top = `${plot.root.offsetTop + 4}px`;
  }

  // One row for each track: its name, and a rectangle for each stretch above normal.
  function drawTracks(chart) {
    const {plot} = chart, {ctx, bbox} = plot, ratio = devicePixelRatio, xs = plot.data[0];
    const rows = plot.series.length - 1, height = bbox.height / rows;
    ctx.save();
    ctx.beginPath(); ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height); ctx.clip();
    ctx.font = `${12 * ratio}px system-ui, sans-serif`;
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    for (let row = 1; row <= rows; row++) {
      const series = plot.series[row], levels = plot.data[row], top = bbox.top + (row - 1) * height;
      ctx.fillStyle = colour("dim");
      ctx.fillText(series.label, bbox.left + 4 * ratio, top + 9 * ratio);
      const bandTop = top + 17 * ratio, band = height - 20 * ratio;
      ctx.fillStyle = colour("line");
      ctx.fillRect(bbox.left, bandTop + band - ratio, bbox.width, ratio);
      let from = 0;
      for (let i = 1; i <= xs.length; i++) {
        if (i < xs.length && (levels[i] === undefined || levels[i] === levels[from])) continue;
        if (levels[from] > 0) {
          const left = Math.max(plot.valToPos(xs[from], "x", true), bbox.left);
          const right = Math.min(plot.valToPos(xs[Math.min(i, xs.length - 1)], "x", true), bbox.left + bbox.width);
          if (right >= left) {
            ctx.fillStyle = colour(`band-${Math.min(3, levels[from])}`);
            ctx.fillRect(left, bandTop, Math.max(right - left, 2 * ratio), band);
            const word = series.rcNames[levels[from]] ?? String(levels[from]);
            if (ctx.measureText(word).width + 6 * ratio < right - left) {
              ctx.fillStyle = colour("ink");
              ctx.fillText(word, left + 3 * ratio, bandTop + band / 2);
            }
          }
        }
        from = i;
      }
    }
    ctx.restore();
  }

  function seriesOf(item, index, asTrack) {
    const name = item.colour ?? index % 7;
    return {
      label: item.label,
      show: item.show ?? true,
      stroke: () => colour(name),
      width: item.width ?? 1,
      dash: item.dash,
      points: {show: false},
      paths: asTrack ? () => null : item.step ? uPlot.paths.stepped({align: 1}) : undefined,
      value: (...given) => legend(item, asTrack || item.step, ...given),
      rcNames: item.names ?? [],
      rcStep: asTrack || item.step,
      rcColour: name,
      rcEnd: item.end,
      ...(item.filled && {fill: () => colour("line"), fillTo: 0}),
    };
  }

  function build(parent, description, data, asTrack) {
    const x = description.x ?? {}, named = (text, unit) => text && unit ? `${text} (${unit})` : text || unit || "";
    const element = document.createElement("div");
    element.className = "rc-chart";
    element.tabIndex = 0;
    element.setAttribute("role", "group");
    const title = named(description.title, description.unit);
    element.setAttribute("aria-label", title || "chart");
    if (title) element.append(Object.assign(document.createElement("p"), {className: "rc-title", textContent: title}));
    const tip = Object.assign(document.createElement("div"), {className: "rc-tip", hidden: true});
    parent.append(element);
    const chart = {element, tip, sync: description.sync, markers: description.markers ?? [], lines: description.lines ?? [],
                   places: []};
    const fills = description.height === "fill";
    const height = fills ? HEIGHT_MIN_PX : description.height ?? (asTrack ? AXES_PX + ROW_PX * description.series.length : 200);
    const axis = {
      stroke: () => colour("dim"), grid: {stroke: () => colour("line"), width: 1}, font: FONT, labelFont: FONT,
      ticks: {stroke: () => colour("line"), width: 1, size: 4}, values: digits,
    };
    const words = description.series.length === 1 && !asTrack ? description.series[0].names : undefined;
    const names = words && Object.keys(words).length ? words : undefined;
    const yAxis = asTrack ? {...axis, size: AXIS_PX, values: () => [], grid: {show: false}, ticks: {show: false}}
      : {...axis, size: AXIS_PX, gap: 3, ...(names && {values: (plot, splits) => splits.map(v => names[v] ?? ""), incrs: [1]})};
    const move = (type) => type === "mousemove" || type === "mouseleave";
    chart.plot = new uPlot({
      width: Math.max(parent.clientWidth, 120), height,
      scales: {
        x: {time: false, ...(x.range && {range: (plot, low, high) => (chart.zoomed ? [low, high] : x.range)})},
        y: asTrack ? {range: [0, 1]} : description.y ? {range: description.y}
          // The names of the lines have room above the curves.
          : description.lines ? {range: (plot, low, high) => [Math.min(0, low ?? 0), (high ?? 1) / .5]} : {},
      },
      axes: [{...axis, size: 26, gap: 3, label: named(x.label, x.unit), labelSize: 18, labelGap: 0}, yAxis],
      series: [
        {label: x.label ?? "x", value: (plot, value) => {
          // Levels hold between their instants: the cursor's own place, not that of the last change.
          if (asTrack && value != null && plot.cursor.left >= 0)
            value = Number(plot.posToVal(plot.cursor.left, "x").toPrecision(5));
          return value == null ? "-" : shown(value) + (x.unit ? ` ${x.unit}` : "");
        }},
        ...description.series.map((item, index) => seriesOf(item, index, asTrack)),
      ],
      legend: {
        markers: {
          show: !asTrack,
          width: 2,
          stroke: (plot, index) => index ? `var(--rc-${plot.series[index].rcColour})` : "transparent",
          dash: (plot, index) => plot.series[index].dash ? "dashed" : "solid",
        },
      },
      cursor: {
        drag: {x: true, y: false, dist: 5, setScale: false},
        y: false,
        points: {show: !asTrack, size: 6},
        dataIdx: (plot, series, nearest, value) => series === 0 || nearest == null ? nearest
          : place(plot, series, nearest, value),
        sync: description.sync ? {key: description.sync, scales: ["x", null], setSeries: false,
                                  filters: {pub: move, sub: move}} : undefined,
        bind: {dblclick: () => () => { handle.zoom(); return null; }},
      },
      hooks: {
        draw: [() => { drawMarkers(chart); drawLines(chart); drawEnds(chart); if (asTrack) drawTracks(chart); }],
        setCursor: [() => tell(chart)],
        setSelect: [plot => {
          const {left, width} = plot.select;
          if (!(width > 0)) return;
          const ends = [plot.posToVal(left, "x"), plot.posToVal(left + width, "x")];
          plot.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
          handle.zoom(...ends);
        }],
      },
    }, data.map(withGaps), element);
    element.append(tip);

    const whole = () => {
      if (x.range) return x.range;
      const xs = group(chart).map(one => one.plot.data[0]).filter(one => one.length);
      return [Math.min(...xs.map(one => one[0])), Math.max(...xs.map(one => one[one.length - 1]))];
    };
    const handle = {
      element, plot: chart.plot,
      setData(values) {
        chart.plot.batch(() => {
          chart.plot.setData(values.map(withGaps), !chart.zoomed);
          if (chart.zoomed) chart.plot.redraw();
        });
      },
      setMarkers(markers) { chart.markers = markers; redraw(chart); },
      setPlaces(places) {
        if (String(places) === String(chart.places)) return;
        chart.places = places;
        redraw(chart);
      },
      show(index, on) { chart.plot.setSeries(index + 1, {show: on}); },
      zoom(low, high) {
        const all = low === undefined, [least, most] = whole();
        if (all) [low, high] = [least, most];
        else [low, high] = [Math.max(low, least), Math.min(high, most)];
        if (!(high > low)) return;
        for (const one of group(chart)) {
          one.zoomed = !all;
          // At once, so that range() says it; uPlot alone would wait for the next microtask.
          one.plot.batch(() => one.plot.setScale("x", {min: low, max: high}));
        }
      },
      range() { return [chart.plot.scales.x.min, chart.plot.scales.x.max]; },
      zoomed() { return Boolean(chart.zoomed); },
      cursor(at) {
        for (const one of group(chart))
          one.plot.setCursor({left: at == null ? -10 : one.plot.valToPos(at, "x"), top: at == null ? -10 : 1}, true, false);
      },
      destroy() {
        watch.disconnect(); every.delete(chart); chart.plot.destroy(); element.remove();
      },
    };
    every.add(chart);
    const watch = new ResizeObserver(() => {
      const {plot} = chart, width = element.clientWidth;
      // Title and legend keep their room.
      const wanted = fills ? Math.max(HEIGHT_MIN_PX, parent.clientHeight - (element.offsetHeight - plot.height)) : height;
      if (width > 0 && (width !== plot.width || wanted !== plot.height)) plot.setSize({width, height: wanted});
    });
    watch.observe(element);
    if (fills) watch.observe(parent);
    reach(chart, handle);
    return handle;
  }

  // Wheel, fingers and keys.
  function reach(chart, handle) {
    const {element, plot} = chart;
    const around = (x, factor) => {
      const [low, high] = handle.range();
      handle.zoom(x - (x - low) * factor, x + (high - x) * factor);
    };
    // The next point on one side that is shown.
    const beside = (x, side) => {
      const xs = Array.from(plot.data[0]), near = (plot.scales.x.max - plot.scales.x.min) / plot.over.clientWidth / 2;
      return (side > 0 ? xs.find(one => one > x + near) : xs.findLast(one => one < x - near)) ?? x;
    };
    const at = event => plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x");
    plot.over.addEventListener("wheel", event => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      around(at(event), event.deltaY < 0 ? .8 : 1.25);
    }, {passive: false});
    const fingers = new Map();
    const held = () => [...fingers.values()].sort((one, other) => one - other);
    let grip = null;
    plot.over.addEventListener("pointerdown", event => {
      if (event.pointerType !== "touch") return;
      fingers.set(event.pointerId, event.clientX);
      if (fingers.size === 2) grip = held().map(x => at({clientX: x}));
    });
    plot.over.addEventListener("pointermove", event => {
      if (!fingers.has(event.pointerId)) return;
      fingers.set(event.pointerId, event.clientX);
      if (fingers.size === 1) { handle.cursor(at(event)); return; }
      // Both fingers keep the values that they took hold of.
      const [left, right] = held(), box = plot.over.getBoundingClientRect();
      if (right - left < 10 || grip === null) return;
      const unit = (grip[1] - grip[0]) / (right - left), low = grip[0] - (left - box.left) * unit;
      handle.zoom(low, low + box.width * unit);
    });
    for (const name of ["pointerup", "pointercancel", "pointerleave"])
      plot.over.addEventListener(name, event => { fingers.delete(event.pointerId); grip = null; });
    element.addEventListener("keydown", event => {
      const [low, high] = handle.range(), side = {ArrowLeft: -1, ArrowRight: 1}[event.key];
      const now = plot.cursor.left >= 0 ? plot.posToVal(plot.cursor.left, "x") : (low + high) / 2;
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (side && event.shiftKey) handle.zoom(low + side * (high - low) / 10, high + side * (high - low) / 10);
      else if (side) handle.cursor(beside(now, side));
      else if (event.key === "+" || event.key === "=") around(now, .5);
      else if (event.key === "-") around(now, 2);
      else if (event.key === "0") handle.zoom();
      else return;
      event.preventDefault();
    });
  }

  return {
    chart: (parent, description, data) => build(parent, description, data, false),
    tracks: (parent, description, data) => build(parent, description, data, true),
    join: tables => uPlot.join(tables),
    setTheme, colour, shown,
  };
})();
