/* Figures of a page: zoom, values at the cursor, choice of runs. The curves are the paths of the page, whose numbers are
   in the units of the axes: a zoom is another transformation of their group.

   Mouse: drag to zoom, double click for everything, ctrl and wheel. Touch: two fingers. Keys on a focused chart: + - 0,
   left and right move the cursor, with shift the view. */
"use strict";
const railhilFigures = (() => {
  const make = (name, ...inside) => { const made = document.createElement(name); made.append(...inside); return made; };
  const numbers = text => text.split(" ").map(Number);
  const shown = (value, digits = 7) => String(Number(value.toPrecision(digits)));
  const SVG = "http://www.w3.org/2000/svg", TIME = "time (s)";
  // Of more runs the others are hidden at first.
  const RUNS_FIRST = 8;
  const all = [];

  // The points of a path of M, L, H and V; null where the line is broken.
  function points(path) {
    const xs = [], ys = [];
    let x = 0, y = 0, set = 0, kind = "M";
    for (const [, letter, number] of path.getAttribute("d").matchAll(/([MLHV])|(-?[\d.]+(?:e[-+]?\d+)?)/g)) {
      if (letter) {
        kind = letter; set = 0;
        if (kind === "M" && xs.length) { xs.push(xs[xs.length - 1]); ys.push(null); }
        continue;
      }
      if (kind === "H") x = Number(number);
      else if (kind === "V") y = Number(number);
      else if (set === 0) { x = Number(number); set = 1; continue; } else { y = Number(number); set = 0; }
      xs.push(x); ys.push(y);
    }
    return {xs, ys};
  }

  // The last place at or before x.
  function before(xs, x) {
    let low = -1, high = xs.length;
    while (high - low > 1) { const half = low + high >> 1; if (xs[half] <= x) low = half; else high = half; }
    return low;
  }

  // The value of a curve at x, and whether it is one of its points; null: it has none there.
  function value(curve, x) {
    const {xs, ys} = curve, at = before(xs, x);
    if (at < 0 || ys[at] === null) return null;
    if (xs[at] === x || curve.step) return at + 1 < xs.length || xs[at] === x ? {y: ys[at], exact: true} : null;
    if (at + 1 >= xs.length || ys[at + 1] === null) return null;
    return {y: ys[at] + (ys[at + 1] - ys[at]) * (x - xs[at]) / (xs[at + 1] - xs[at]), exact: false};
  }

  function ticks(low, high, most) {
    const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find(factor => factor * power >= rough * (1 - 1e-9));
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), found = [];
    for (let number = Math.ceil(low / step - 1e-9); number * step <= high + step * 1e-9; number++)
      found.push([number * step, (number * step + 0).toFixed(decimals)]);
    return found;
  }

  class Chart {
    constructor(element) {
      this.element = element;
      this.svg = element.querySelector(":scope > svg");
      this.plot = this.svg.querySelector(".plot");
      this.data = this.plot.querySelector(".data");
      this.sync = element.dataset.sync ?? "";
      this.log = "log" in element.dataset;
      this.box = numbers(this.svg.dataset.box);
      this.home = {x: numbers(this.svg.dataset.x), y: numbers(this.svg.dataset.y)};
      this.x = [...this.home.x]; this.y = [...this.home.y];
      this.fixed = "fixed" in element.dataset;
      this.names = this.svg.dataset.names.split("|").map(text => text
        ? text.split(";").map(one => { const at = one.indexOf("="); return [Number(one.slice(0, at)), one.slice(at + 1)]; }) : []);
      this.hasNumbers = Boolean(this.svg.querySelector("text.x"));
      const outputs = [...element.querySelectorAll(".keys output")];
      this.curves = [...this.data.querySelectorAll(".curve")].map((path, place) => ({
        path, output: outputs[place], step: "step" in path.dataset, within: Number(path.dataset.within ?? 0),
        unit: path.dataset.unit ?? "", run: path.dataset.run, column: path.dataset.column,
      }));
      this.said = element.querySelector(".keys .at");
      this.line = document.createElementNS(SVG, "path");
      this.line.setAttribute("class", "cursor");
      this.plot.append(this.line);
    }

    // Read when they are first needed.
    read() {
      for (const curve of this.curves) if (!curve.xs) Object.assign(curve, points(curve.path));
      return this.curves.filter(curve => !curve.path.classList.contains("off"));
    }

    group() { return this.sync ? all.filter(one => one.sync === this.sync) : [this]; }
    get zoomed() { return this.x[0] !== this.home.x[0] || this.x[1] !== this.home.x[1]; }

    show(x) {
      this.x = x;
      this.y = [...this.home.y];
      if (this.zoomed && !this.fixed) {
        let low = Infinity, high = -Infinity;
        const take = y => { if (y !== null && y !== undefined) { low = Math.min(low, y); high = Math.max(high, y); } };
        for (const curve of this.read()) {
          for (const end of x) take(value(curve, end)?.y);
          for (let at = Math.max(0, before(curve.xs, x[0])); at < curve.xs.length && curve.xs[at] <= x[1]; at++)
            if (curve.xs[at] >= x[0]) take(curve.ys[at]);
        }
        if (high > low) this.y = [low - .05 * (high - low), high + .05 * (high - low)];
      }
      this.draw();
    }

    toX(x) { return (x - this.x[0]) / (this.x[1] - this.x[0]) * this.box[2]; }
    toY(y) { return (this.y[1] - y) / (this.y[1] - this.y[0]) * this.box[3]; }

    draw() {
      const [left, top, width, height] = this.box;
      const a = width / (this.x[1] - this.x[0]), d = -height / (this.y[1] - this.y[0]);
      this.data.setAttribute("transform", `matrix(${a} 0 0 ${d} ${-a * this.x[0]} ${-d * this.y[1]})`);
      for (const point of this.plot.querySelectorAll(".point")) {
        const [x, y] = numbers(point.dataset.at);
        point.setAttribute("transform", `translate(${this.toX(x)} ${this.toY(y)})`);
      }
      let before = -Infinity;
      for (const line of this.plot.querySelectorAll(".across")) {
        const x = this.toX(Number(line.dataset.at)), name = line.querySelector("text");
        line.setAttribute("transform", `translate(${x} 0)`);
        if (!name) continue;
        const room = x - before >= 13;
        name.setAttribute("visibility", room ? "visible" : "hidden");
        name.setAttribute("y", x < 14 ? 11 : -3);
        if (room && x >= 0) before = x < 14 ? x + 17 : x;
      }
      const axes = this.svg.querySelector(".axes"), made = [];
      const add = (name, given, text = "") => {
        const one = document.createElementNS(SVG, name);
        for (const [key, value] of Object.entries(given)) one.setAttribute(key, value);
        one.textContent = text;
        made.push(one);
      };
      const marks = (range, names, most) => {
        const inside = ([at]) => range[0] <= at && at <= range[1];
        if (this.log) return names.length ? names.map(([at, name]) => [Math.log10(at), name]).filter(inside)
          : ticks(...range, most).filter(([at]) => Number.isInteger(at)).map(([at]) => [at, shown(10 ** at)]);
        return names.length ? names.filter(inside) : ticks(...range, most);
      };
      for (const [at, text] of marks(this.y, this.names[1], Math.max(2, Math.floor(height / 32)))) {
        add("path", {d: `M${left} ${top + this.toY(at)}h${width}`});
        add("text", {x: left - 5, y: top + this.toY(at) + 4, "text-anchor": "end"}, text);
      }
      for (const [at, text] of marks(this.x, this.names[0], Math.max(2, Math.floor(width / 62)))) {
        add("path", {d: `M${left + this.toX(at)} ${top}v${height}`});
        if (this.hasNumbers) add("text", {x: left + this.toX(at), y: top + height + 14, "text-anchor": "middle"}, text);
      }
      axes.replaceChildren(...made);
    }

    zoom(low, high) {
      for (const one of this.group()) {
        const [least, most] = one.home.x;
        const x = low === undefined ? [least, most] : [Math.max(low, least), Math.min(high, most)];
        if (x[1] > x[0]) one.show(x);
      }
    }

    // Values at x in every chart of the group; null: none.
    cursor(x) {
      for (const one of this.group()) {
        one.at = x;
        one.line.setAttribute("d", x === null ? "" : `M${one.toX(x)} 0v${one.box[3]}`);
        if (x === null) { for (const curve of one.curves) curve.output.textContent = ""; continue; }
        for (const curve of one.read()) {
          const found = value(curve, x), number = found && (one.log ? 10 ** found.y : found.y);
          const name = found && one.names[1].find(([at]) => at === number)?.[1];
          const unit = curve.unit && ` ${curve.unit}`, within = curve.within && !found?.exact ? ` ± ${curve.within}` : "";
          curve.output.textContent = !found ? "-" : name ?? (found.exact ? `${shown(number)}${unit}`
            : `≈ ${shown(number, 5)}${within}${unit}`);
        }
      }
      for (const one of this.group())
        one.said.textContent = x === null ? "" : `at ${shown(one.log ? 10 ** x : x)}`;
    }

    // Curves and points as the page has them.
    restore() {
      for (const point of this.plot.querySelectorAll(".point")) point.dataset.at = point.dataset.time ??= point.dataset.at;
      for (const path of this.data.children) if (path.dataset.d) path.setAttribute("d", path.dataset.d);
      this.home.x = numbers(this.svg.dataset.x);
      const label = this.svg.querySelector("text.x");
      if (label) label.textContent = label.dataset.label ??= label.textContent;
      for (const curve of this.curves) delete curve.xs;
    }

    // Each path over the way of its run: instants and positions.
    move(ways, ends) {
      for (const path of this.data.children) {
        const way = ways.get(path.dataset.run) ?? ways.values().next().value;
        const {xs, ys} = points(path), step = "step" in path.dataset || !(path.classList.contains("curve") || path.classList.contains("band"));
        path.dataset.d ??= path.getAttribute("d");
        let text = "", open = false;
        xs.forEach((x, at) => {
          const to = value(way, Math.min(Math.max(x, way.xs[0]), way.xs[way.xs.length - 1]));
          if (ys[at] === null || !to) { open = false; return; }
          text += !open ? `M${to.y} ${ys[at]}` : step ? `H${to.y}V${ys[at]}` : ` ${to.y} ${ys[at]}`;
          open = true;
        });
        path.setAttribute("d", text);
      }
      for (const point of this.plot.querySelectorAll(".point")) {
        const [x, y] = numbers(point.dataset.at), to = value(ways.get(point.dataset.run) ?? ways.values().next().value, x);
        point.dataset.at = `${to ? to.y : ends[1]} ${y}`;
      }
      this.home.x = ends;
      const label = this.svg.querySelector("text.x");
      if (label) { label.dataset.label ??= label.textContent; label.textContent = document.querySelector("#figures .bar").dataset.label; }
      for (const curve of this.curves) delete curve.xs;
    }

    // The place of the pointer; the nearest point of a curve of this chart, if there is one within 6 px.
    under(event, exactly = false) {
      const matrix = this.plot.getScreenCTM(), width = this.box[2];
      const share = (event.clientX - matrix.e) / matrix.a / width;
      const x = this.x[0] + share * (this.x[1] - this.x[0]);
      if (exactly) return x;
      let best = x, far = 6 / width * (this.x[1] - this.x[0]);
      for (const curve of this.read()) {
        const at = before(curve.xs, x);
        for (const place of [at, at + 1]) {
          const off = Math.abs(curve.xs[place] - x);
          if (off < far) { far = off; best = curve.xs[place]; }
        }
      }
      return best;
    }

    listen() {
      const {element, svg} = this, fingers = new Map();
      let from = null, grip = null;
      const around = (x, factor) => this.zoom(x - (x - this.x[0]) * factor, x + (this.x[1] - x) * factor);
      const held = () => [...fingers.values()].sort((one, other) => one - other);
      svg.addEventListener("pointermove", event => {
        if (event.pointerType === "touch" && fingers.has(event.pointerId)) {
          fingers.set(event.pointerId, event.clientX);
          if (fingers.size === 2 && grip) {
            // Both fingers keep the values that they took hold of.
            const [left, right] = held(), scale = this.plot.getScreenCTM(), width = this.box[2] * scale.a;
            if (right - left < 10) return;
            const unit = (grip[1] - grip[0]) / (right - left), low = grip[0] - (left - scale.e) * unit;
            this.zoom(low, low + width * unit);
            return;
          }
        }
        this.cursor(this.under(event));
        if (from !== null) this.mark(from, this.under(event, true));
      });
      svg.addEventListener("pointerdown", event => {
        if (event.pointerType === "touch") {
          fingers.set(event.pointerId, event.clientX);
          if (fingers.size === 2) grip = held().map(clientX => this.under({clientX}, true));
        } else if (event.button === 0) {
          from = this.under(event, true);
          svg.setPointerCapture(event.pointerId);
        }
      });
      const leave = event => { fingers.delete(event.pointerId); grip = null; from = null; this.mark(); };
      svg.addEventListener("pointerup", event => {
        const to = this.under(event, true), start = from;
        leave(event);
        if (start !== null && Math.abs(to - start) > .01 * (this.x[1] - this.x[0])) this.zoom(Math.min(start, to), Math.max(start, to));
      });
      svg.addEventListener("pointercancel", leave);
      svg.addEventListener("pointerleave", event => { if (from === null) { leave(event); this.cursor(null); } });
      svg.addEventListener("dblclick", () => this.zoom());
      svg.addEventListener("wheel", event => {
        if (!event.ctrlKey) return;
        event.preventDefault();
        around(this.under(event, true), event.deltaY < 0 ? .8 : 1.25);
      }, {passive: false});
      element.addEventListener("keydown", event => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const [low, high] = this.x, side = {ArrowLeft: -1, ArrowRight: 1}[event.key], now = this.at ?? (low + high) / 2;
        if (side && event.shiftKey) this.zoom(low + side * (high - low) / 10, high + side * (high - low) / 10);
        else if (side) this.cursor(Math.min(Math.max(now + side * (high - low) / 200, low), high));
        else if (event.key === "+" || event.key === "=") around(now, .5);
        else if (event.key === "-") around(now, 2);
        else if (event.key === "0") this.zoom();
        else return;
        event.preventDefault();
      });
    }

    // The stretch that is being chosen.
    mark(from, to) {
      this.plot.querySelector(".chosen")?.remove();
      if (from === undefined) return;
      const one = document.createElementNS(SVG, "path");
      one.setAttribute("class", "chosen");
      one.setAttribute("d", `M${this.toX(from)} 0H${this.toX(to)}V${this.box[3]}H${this.toX(from)}Z`);
      this.plot.append(one);
    }
  }

  // Everything over time is drawn over the position of its run, or over time again.
  function over(column) {
    const charts = all.filter(one => one.sync === TIME);
    const ways = new Map();
    for (const chart of charts) {
      chart.restore();
      if (column) for (const curve of chart.curves) if (curve.column === column) ways.set(curve.run, points(curve.path));
    }
    if (column) {
      const ends = [...ways.values()].flatMap(way => way.ys.filter(y => y !== null));
      for (const chart of charts) chart.move(ways, [Math.min(...ends), Math.max(...ends)]);
    }
    for (const chart of charts) chart.show([...chart.home.x]);
  }

  function dress() {
    const bar = document.querySelector("#figures .bar");
    if (!bar || !all.length) return;
    let used = all.find(one => one.sync === TIME) ?? all[0];
    for (const chart of all) chart.element.addEventListener("pointerdown", () => { used = chart; });
    const press = (text, work) => { const button = make("button", text); button.type = "button"; button.addEventListener("click", work); bar.append(button); };
    const check = (text, change) => {
      const box = make("input"); box.type = "checkbox"; box.checked = true;
      box.addEventListener("change", () => change(box.checked));
      return make("label", box, ` ${text}`);
    };
    if (bar.dataset.over) {
      const select = make("select", new Option("time", ""), new Option(bar.dataset.label, bar.dataset.over));
      select.id = "over";
      select.addEventListener("change", () => over(select.value));
      bar.append(make("label", "over ", select));
    }
    const around = factor => { const [low, high] = used.x, middle = (low + high) / 2, half = (high - low) / 2 * factor; used.zoom(middle - half, middle + half); };
    const shift = side => { const [low, high] = used.x, far = (high - low) / 4 * side; used.zoom(low + far, high + far); };
    press("◀", () => shift(-1)); press("+", () => around(.5)); press("−", () => around(2)); press("▶", () => shift(1));
    press("everything", () => { for (const chart of all) chart.zoom(); });
    bar.append(check("events", on => document.body.classList.toggle("without-events", !on)));
    press("dark / light", () => {
      const root = document.documentElement;
      root.dataset.theme = getComputedStyle(root).colorScheme === "dark" ? "light" : "dark";
    });
    const runs = JSON.parse(bar.dataset.runs);
    if (runs.length > 1) {
      const list = make("fieldset", make("legend", "runs"));
      runs.forEach((name, run) => {
        const show = on => { for (const one of document.querySelectorAll(`.chart [data-run="${run}"]`)) one.classList.toggle("off", !on); };
        const choice = check(name, show);
        if (run >= RUNS_FIRST) { choice.querySelector("input").checked = false; show(false); }
        list.append(choice);
      });
      bar.after(list);
    }
    // An entry of the legend shows and hides its curve.
    for (const chart of all) for (const curve of chart.curves)
      curve.output.parentElement.addEventListener("click", () => {
        for (const one of [curve.path, curve.output.parentElement]) one.classList.toggle("off");
      });
  }

  document.documentElement.classList.add("scripts");
  for (const element of document.querySelectorAll(".chart")) all.push(new Chart(element));
  for (const chart of all) chart.listen();
  dress();
  // For tests and for whoever looks with the browser's console.
  return {charts: all, value};
})();
