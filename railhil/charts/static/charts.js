/* Charts of streams: a thin layer over uPlot. Plain arrays in, nothing fetched. What a reader does with them: view.js.

   railhilCharts.chart(parent, description, data)   curves                        -> handle
   railhilCharts.tracks(parent, description, data)  levels over x, as bands       -> handle
   railhilCharts.join([[x, y, ...], ...])           data of several x, as uPlot.join
   railhilCharts.drawn(element)                     of a chart's element the values by their labels, for tests
   railhilCharts.setTheme("dark" | "light" | "")    ""; what the system asks for; redraws all charts
   railhilCharts.colour(name)                       CSS colour of "0".."6", "target", "ink", "dim", "fault" ...

   description: {
     title, unit,                    above the chart: "title (unit)"; both may be empty
     bare,                           the title is read out only, because something else shows it
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
     setPlaces([x, ...], draws),     triangles below the chart's curves: where something is now; draws: at once, else with the data
     show(place, on),                one series, counted from 0
     zoom(low, high), zoom(),        range of x of the chart and those of its sync word; without figures: everything
     range(), zoomed(),              [low, high] as shown; whether that is less than everything
     cursor(x),                      puts the cursor at x, as hovering does; null: away
     destroy(), element, plot        plot: the uPlot
   } */
"use strict";
const railhilCharts = (() => {
  const FONT = "12px system-ui, sans-serif", AXIS_PX = 56, NEAR_PX = 6, ROW_PX = 38, AXES_PX = 62, HEIGHT_MIN_PX = 80, NAMES_PX = 100;
  const every = new Set();
  const dark = matchMedia("(prefers-color-scheme: dark)");

  const colour = name => getComputedStyle(document.documentElement).getPropertyValue(`--rc-${name}`).trim();
  const {shown, readout} = railhilView;

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

  // The instant or place of the legend without a cursor: where something is now, else the last one.
  const restX = ({places, plot}) => places[0] ?? plot.data[0].at(-1);

  function legend(chart, item, holds, plot, value, series, index) {
    let at = plot.cursor.idx;
    if (index == null) {
      if (chart.plot !== plot || !plot.data[0].length) return "-";
      at = railhilView.before(plot.data[0], restX(chart)) - 1;
      if (at < 0) return "-";
      value = plot.data[series][place(plot, series, at, plot.data[0][at])];
    }
    return holds || at == null || plot.data[series][at] !== undefined ? readout(value, true, item)
      : readout(onLine(plot, series, at), false, item);
  }

  // A legend without a cursor follows what is drawn.
  function rest({plot}) { if (plot.cursor.left < 0) plot.setLegend({idx: null}, false); }

  function digits(plot, splits, axis, space, step) {
    const decimals = railhilView.decimals(step);
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
        // Infinity: as far as the chart goes.
        const end = Math.min(plot.valToPos(marker.until, "x", true), bbox.left + bbox.width);
        if (end > x) ctx.fillRect(x, bbox.top, end - x, bbox.height);
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
    const rooms = railhilView.rooms(lines.map(({at}) => plot.valToPos(at, "x")));
    lines.forEach(({at, name}, number) => {
      const x = plot.valToPos(at, "x", true), {room, right} = rooms[number];
      ctx.strokeStyle = ctx.fillStyle = colour("dim");
      ctx.lineWidth = ratio;
      ctx.setLineDash([2 * ratio, 2 * ratio]);
      ctx.beginPath(); ctx.moveTo(x, bbox.top); ctx.lineTo(x, bbox.top + bbox.height); ctx.stroke();
      if (!room) return;
      ctx.save();
      ctx.translate(x, bbox.top);
      ctx.rotate(-Math.PI / 2);
      ctx.setLineDash([]);
      ctx.strokeStyle = colour("paper");
      ctx.lineWidth = 3 * ratio;
      ctx.lineJoin = "round";
      ctx.textBaseline = right ? "top" : "bottom";
      for (const draw of ["strokeText", "fillText"]) ctx[draw](name, -4 * ratio, (right ? 3 : -3) * ratio);
      ctx.restore();
    });
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
  function drawEnds({plot, lines}) {
    const {ctx, bbox} = plot, ratio = devicePixelRatio, {min, max} = plot.scales.x, xs = plot.data[0], room = 13 * ratio;
    // Left of the name of a line at the right edge.
    const right = bbox.left + bbox.width, edge = Math.min(right - 3 * ratio,
      ...lines.map(({at}) => plot.valToPos(at, "x", true) - 18 * ratio).filter(x => right - 40 * ratio < x && x < right));
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
      const fits = x + 6 * ratio + ctx.measureText(series.rcEnd).width <= edge;
      ctx.textAlign = fits ? "left" : "right";
      ctx.fillStyle = colour(series.rcColour);
      for (const draw of ["strokeText", "fillText"]) ctx[draw](series.rcEnd, fits ? x + 5 * ratio : edge, tops[at]);
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

  function seriesOf(chart, item, index, asTrack) {
    const name = item.colour ?? index % 7;
    return {
      label: item.label,
      show: item.show ?? true,
      stroke: () => colour(name),
      width: item.width ?? 1,
      dash: item.dash,
      points: {show: false},
      paths: asTrack ? () => null : item.step ? uPlot.paths.stepped({align: 1}) : undefined,
      value: (...given) => legend(chart, item, asTrack || item.step, ...given),
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
    if (title && !description.bare) element.append(Object.assign(document.createElement("p"), {className: "rc-title", textContent: title}));
    const tip = Object.assign(document.createElement("div"), {className: "rc-tip", hidden: true});
    parent.append(element);
    const chart = {element, tip, markers: description.markers ?? [], lines: description.lines ?? [],
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
      // Without a title the unit stands beside the axis.
      : {...axis, size: AXIS_PX, gap: 3, ...(description.bare && description.unit && {label: description.unit, labelSize: 14, labelGap: 0}), ...(names && {values: (plot, splits) => splits.map(v => names[v] ?? ""), incrs: [1]})};
    chart.plot = new uPlot({
      width: Math.max(parent.clientWidth, 120), height,
      scales: {
        x: {time: false, ...(x.range && {range: (plot, low, high) => (chart.zoomed ? [low, high] : x.range)})},
        y: asTrack ? {range: [0, 1]} : description.y ? {range: description.y}
          // The names of the lines have room above the curves, in a high chart a smaller share.
          : description.lines ? {range: (plot, low, high) => [Math.min(0, low ?? 0), Math.max(0, high ?? 1)
            / (!description.lines.length ? .95 : description.height === "fill" ? Math.max(.6, 1 - NAMES_PX * devicePixelRatio / plot.bbox.height) : .5)]} : {},
      },
      axes: [{...axis, size: 26, gap: 3, label: named(x.label, x.unit), labelSize: 18, labelGap: 0}, yAxis],
      series: [
        {label: x.label ?? "x", value: (plot, value) => {
          // Levels hold between their instants: the cursor's own place, not that of the last change.
          if (asTrack && value != null && plot.cursor.left >= 0)
            value = Number(plot.posToVal(plot.cursor.left, "x").toPrecision(5));
          if (value == null && chart.plot === plot) value = restX(chart);
          return value == null ? "-" : shown(value) + (x.unit ? ` ${x.unit}` : "");
        }},
        ...description.series.map((item, index) => seriesOf(chart, item, index, asTrack)),
      ],
      legend: {
        markers: {
          show: !asTrack,
          width: 2,
          // The colours of the scheme would be those of the beginning.
          fill: "transparent",
          stroke: (plot, index) => index ? `var(--rc-${plot.series[index].rcColour})` : "transparent",
          dash: (plot, index) => plot.series[index].dash ? "dashed" : "solid",
        },
      },
      cursor: {
        drag: {setScale: false, click: () => {}},
        y: false,
        points: {show: !asTrack, size: 6},
        dataIdx: (plot, series, nearest, value) => series === 0 || nearest == null ? nearest
          : place(plot, series, nearest, value),
        // What a reader does is heard by the view.
        bind: Object.fromEntries(["mousedown", "mouseup", "mousemove", "mouseleave", "click", "dblclick"].map(name => [name, () => null])),
      },
      hooks: {
        draw: [() => { drawMarkers(chart); drawLines(chart); drawEnds(chart); if (asTrack) drawTracks(chart); }],
        setCursor: [() => tell(chart)],
      },
    }, data.map(withGaps), element);
    element.append(tip);

    const {plot} = chart, pixel = x => plot.valToPos(x, "x");
    const view = new railhilView.View({
      element, surface: plot.over, sync: description.sync,
      frame: () => plot.over.getBoundingClientRect(),
      range: () => [plot.scales.x.min, plot.scales.x.max],
      whole: () => x.range ?? [plot.data[0][0], plot.data[0].at(-1)],
      samples: () => [plot.data[0]],
      show(low, high, isAll) {
        chart.zoomed = !isAll;
        // At once, so that range() says it; uPlot alone would wait for the next microtask.
        plot.batch(() => plot.setScale("x", {min: low, max: high}));
      },
      point(at) {
        const isAway = at === null || plot.scales.x.min == null;
        plot.setCursor({left: isAway ? -10 : pixel(at), top: isAway ? -10 : 1}, true, false);
      },
      choose(from, to) {
        const ends = from === undefined ? [0, 0] : [pixel(from), pixel(to)].sort((one, other) => one - other);
        plot.setSelect({left: ends[0], top: 0, width: ends[1] - ends[0], height: plot.over.clientHeight}, false);
      },
    });
    every.add(chart);
    const watch = new ResizeObserver(() => {
      const width = element.clientWidth;
      // Title and legend keep their room.
      const wanted = fills ? Math.max(HEIGHT_MIN_PX, parent.clientHeight - (element.offsetHeight - plot.height)) : height;
      if (width > 0 && (width !== plot.width || wanted !== plot.height)) plot.setSize({width, height: wanted});
    });
    watch.observe(element);
    if (fills) watch.observe(parent);
    return {
      element, plot,
      setData(values) {
        plot.batch(() => {
          plot.setData(values.map(withGaps), !chart.zoomed);
          // With all of the data uPlot does the legend itself.
          if (chart.zoomed) { plot.redraw(); rest(chart); }
        });
      },
      setMarkers(markers) { chart.markers = markers; redraw(chart); },
      setPlaces(places, draws = true) {
        if (String(places) === String(chart.places)) return;
        chart.places = places;
        if (draws) { redraw(chart); rest(chart); }
      },
      show(index, on) { plot.setSeries(index + 1, {show: on}); },
      zoom: (...ends) => view.zoom(...ends),
      range: view.drawing.range,
      zoomed: () => Boolean(chart.zoomed),
      cursor: at => view.cursor(at ?? null),
      destroy() { watch.disconnect(); every.delete(chart); view.close(); plot.destroy(); element.remove(); },
    };
  }

  return {
    chart: (parent, description, data) => build(parent, description, data, false),
    tracks: (parent, description, data) => build(parent, description, data, true),
    join: tables => uPlot.join(tables),
    drawn(element) {
      const {plot} = [...every].find(chart => chart.element === element);
      return Object.fromEntries(plot.series.map(({label}, at) => [label, Array.from(plot.data[at])]));
    },
    setTheme, colour,
  };
})();
