/* Figures of a page: the curves are the paths of the page, whose numbers are in the units of the axes; another range is
   another transformation of their group. Choice of runs and of the axis. What a reader does with a chart: view.js. */
"use strict";
const railhilFigures = (() => {
  const make = (name, ...inside) => { const made = document.createElement(name); made.append(...inside); return made; };
  const numbers = text => text.split(" ").map(Number);
  const {shown, before} = railhilView;
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

  // The value of a curve at x, and whether it is one of its points; null: it has none there.
  function value(curve, x) {
    const {xs, ys} = curve, at = before(xs, x) - 1;
    if (at < 0 || ys[at] === null) return null;
    if (xs[at] === x || curve.step) return at + 1 < xs.length || xs[at] === x ? {y: ys[at], exact: true} : null;
    if (at + 1 >= xs.length || ys[at + 1] === null) return null;
    return {y: ys[at] + (ys[at + 1] - ys[at]) * (x - xs[at]) / (xs[at + 1] - xs[at]), exact: false};
  }

  function ticks(low, high, most) {
    const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find(factor => factor * power >= rough * (1 - 1e-9));
    const decimals = railhilView.decimals(step), found = [];
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
      this.surface = this.svg;
      this.sync = element.dataset.sync ?? "";
      this.log = "log" in element.dataset;
      this.box = numbers(this.svg.dataset.box);
      this.home = {x: numbers(this.svg.dataset.x), y: numbers(this.svg.dataset.y)};
      this.x = [...this.home.x]; this.y = [...this.home.y];
      this.fixed = "fixed" in element.dataset;
      this.names = this.svg.dataset.names.split("|").map(text => text
        ? text.split(";").map(one => { const at = one.indexOf("="); return [Number(one.slice(0, at)), one.slice(at + 1)]; }) : []);
      this.words = Object.fromEntries(this.names[1]);
      this.hasNumbers = Boolean(this.svg.querySelector("text.x"));
      const outputs = [...element.querySelectorAll(".keys output")];
      this.curves = [...this.data.querySelectorAll(".curve")].map((path, place) => ({
        path, output: outputs[place], step: "step" in path.dataset, within: Number(path.dataset.within ?? 0),
        unit: path.dataset.unit, names: this.words, run: path.dataset.run, column: path.dataset.column,
      }));
      this.said = element.querySelector(".keys .at");
      this.line = document.createElementNS(SVG, "path");
      this.line.setAttribute("class", "cursor");
      this.plot.append(this.line);
      this.view = new railhilView.View(this);
    }

    // Read when they are first needed.
    read() {
      for (const curve of this.curves) if (!curve.xs) Object.assign(curve, points(curve.path));
      return this.curves.filter(curve => !curve.path.classList.contains("off"));
    }

    get zoomed() { return this.x[0] !== this.home.x[0] || this.x[1] !== this.home.x[1]; }

    frame() { const {a, e} = this.plot.getScreenCTM(); return {left: e, width: a * this.box[2]}; }
    range() { return this.x; }
    whole() { return this.home.x; }
    samples() { return this.read().map(curve => curve.xs); }

    show(...ends) {
      this.x = ends.slice(0, 2);
      this.y = [...this.home.y];
      if (this.zoomed && !this.fixed) {
        let low = Infinity, high = -Infinity;
        const take = y => { if (y !== null && y !== undefined) { low = Math.min(low, y); high = Math.max(high, y); } };
        for (const curve of this.read()) {
          for (const end of this.x) take(value(curve, end)?.y);
          curve.xs.forEach((x, at) => { if (this.x[0] <= x && x <= this.x[1]) take(curve.ys[at]); });
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
      const lines = [...this.plot.querySelectorAll(".across")], at = line => this.toX(Number(line.dataset.at));
      for (const line of lines) line.setAttribute("transform", `translate(${at(line)} 0)`);
      const named = lines.filter(line => line.lastChild.tagName === "text");
      railhilView.rooms(named.map(at)).forEach(({room, right}, number) => {
        named[number].lastChild.setAttribute("visibility", room ? "visible" : "hidden");
        named[number].lastChild.setAttribute("y", right ? 11 : -3);
      });
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

    // Values at x; null: none.
    point(x) {
      const number = y => this.log ? 10 ** y : y;
      this.line.setAttribute("d", x === null ? "" : `M${this.toX(x)} 0v${this.box[3]}`);
      this.said.textContent = x === null ? "" : `at ${shown(number(x))}`;
      for (const curve of x === null ? this.curves : this.read()) {
        const found = x === null ? null : value(curve, x);
        curve.output.textContent = x === null ? "" : railhilView.readout(found && number(found.y), found?.exact, curve);
      }
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

    // The stretch that is being chosen.
    choose(from, to) {
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
    for (const chart of charts) chart.show(...chart.home.x);
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
    const around = factor => used.view.around((used.x[0] + used.x[1]) / 2, factor), shift = share => used.view.shift(share);
    press("◀", () => shift(-.25)); press("+", () => around(.5)); press("−", () => around(2)); press("▶", () => shift(.25));
    press("everything", () => { for (const chart of all) chart.view.zoom(); });
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
  dress();
  // For tests and for whoever looks with the browser's console.
  return {charts: all, value};
})();
