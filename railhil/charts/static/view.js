/* What a reader does with a chart, whoever draws it: zoom, cursor and its values, keys, fingers, room for names, digits.
   charts.js (uPlot, for streams) and figures.js (the SVG of a page) draw, and have nothing of this.

   new railhilView.View(drawing)     listens, and draws the charts of one sync word together; .zoom() .cursor() .around() .shift()
   railhilView.shown(number)         a number as a legend writes it: 7 significant digits
   railhilView.readout(value, isPoint, {names, unit, within})   a value at the cursor; ≈: between two points of its curve
   railhilView.rooms([px, ...])      of names along lines from left to right: {room, right}: its side of the line
   railhilView.decimals(step)        of the numbers at an axis with this step
   railhilView.before(xs, x, count)  how many of the first values are at or before x; xs ascending

   drawing: {
     element, surface,               what has the focus; what takes mouse and fingers
     sync,                           charts with the same word share cursor and zoom; empty: this one is alone
     frame(), range(), whole(),      {left, width} of the axes in px of the screen; [low, high] as shown, and without a zoom
     show(low, high, isAll),         draws another range
     point(x),                       cursor and values at x; null: none
     choose(from, to),               the stretch that is being chosen; without figures: none
     samples(),                      arrays of x, ascending: where the curves that are shown have a point
   }
   Mouse: drag to zoom, double click for everything, ctrl and wheel. Touch: two fingers. Keys on a focused chart: + - 0,
   left and right move the cursor to the next sample, with shift the view. */
"use strict";
const railhilView = (() => {
  const NEAR_PX = 6, DRAG_PX = 5, NAME_PX = 13, EDGE_PX = 14, OTHER_SIDE_PX = 17;
  const views = new Set();

  const shown = (value, digits = 7) => value == null || Number.isNaN(value) ? "-" : String(Number(value.toPrecision(digits)));

  function readout(value, isPoint, {names, unit, within}) {
    if (value == null || Number.isNaN(value)) return "-";
    if (names?.[value] !== undefined) return names[value];
    const ending = unit ? ` ${unit}` : "";
    return isPoint ? shown(value) + ending : `≈ ${shown(value, 5)}${within ? ` ± ${shown(within, 2)}` : ""}${ending}`;
  }

  function rooms(places) {
    let before = -Infinity;
    return places.map(x => {
      const room = x >= 0 && x - before >= NAME_PX, right = x < EDGE_PX;
      // Of the first one the name stands on the other side.
      if (room) before = right ? x + OTHER_SIDE_PX : x;
      return {room, right};
    });
  }

  function decimals(step) {
    let found = 0;
    while (found < 9 && Math.abs(step * 10 ** found - Math.round(step * 10 ** found)) > 1e-6) found++;
    return found;
  }

  // The number of values at or before x, of the first `high` ones.
  function before(xs, x, high = xs.length) {
    let low = 0;
    while (low < high) { const half = low + high >> 1; if (xs[half] <= x) low = half + 1; else high = half; }
    return low;
  }

  class View {
    constructor(drawing) {
      this.drawing = drawing;
      this.at = null;
      views.add(this);
      this.listen();
    }

    close() { views.delete(this); }
    group() { const {sync} = this.drawing; return sync ? [...views].filter(one => one.drawing.sync === sync) : [this]; }

    // Without figures: everything.
    zoom(low, high) {
      for (const {drawing} of this.group()) {
        const [least, most] = drawing.whole(), isAll = low === undefined;
        const ends = isAll ? [least, most] : [Math.max(low, least), Math.min(high, most)];
        if (ends[1] > ends[0]) drawing.show(...ends, isAll);
      }
    }

    around(x, factor) {
      const [low, high] = this.drawing.range();
      this.zoom(x - (x - low) * factor, x + (high - x) * factor);
    }

    // By a share of what is shown, up to the ends.
    shift(share) {
      const [low, high] = this.drawing.range(), [least, most] = this.drawing.whole();
      const by = Math.min(Math.max(share * (high - low), least - low), most - high);
      this.zoom(low + by, high + by);
    }

    cursor(x) {
      for (const view of this.group()) { view.at = x; view.drawing.point(x); }
    }

    // The next sample on a side of x (-1, 1); x if there is none.
    next(x, side) {
      const found = this.drawing.samples().map(xs => {
        let at = side > 0 ? before(xs, x) : before(xs, x) - 1;
        while (side < 0 && xs[at] >= x) at--;
        return xs[at];
      }).filter(one => one !== undefined);
      return found.length ? Math[side > 0 ? "min" : "max"](...found) : x;
    }

    // The nearest sample, if there is one within 6 px.
    near(x, width) {
      const [low, high] = this.drawing.range();
      let best = x, far = NEAR_PX / width * (high - low);
      for (const xs of this.drawing.samples()) {
        const at = before(xs, x);
        for (const one of [xs[at - 1], xs[at]]) if (Math.abs(one - x) < far) { far = Math.abs(one - x); best = one; }
      }
      return best;
    }

    listen() {
      const {drawing} = this, {element, surface} = drawing, fingers = new Map();
      let from = null, grip = null, dragged = false;
      const place = clientX => {
        const {left, width} = drawing.frame(), [low, high] = drawing.range();
        return low + (clientX - left) / width * (high - low);
      };
      const held = () => [...fingers.values()].sort((one, other) => one - other);
      const leave = event => { fingers.delete(event.pointerId); grip = null; from = null; drawing.choose(); };
      surface.addEventListener("pointermove", event => {
        if (fingers.has(event.pointerId)) {
          fingers.set(event.pointerId, event.clientX);
          if (grip) {
            // Both fingers keep the values that they took hold of.
            const [left, right] = held(), frame = drawing.frame();
            if (right - left < 10) return;
            const unit = (grip[1] - grip[0]) / (right - left), low = grip[0] - (left - frame.left) * unit;
            this.zoom(low, low + frame.width * unit);
            return;
          }
        }
        this.cursor(this.near(place(event.clientX), drawing.frame().width));
        if (from === null) return;
        dragged ||= Math.abs(event.clientX - from.clientX) > DRAG_PX;
        drawing.choose(from.x, place(event.clientX));
      });
      surface.addEventListener("pointerdown", event => {
        dragged = false;
        if (event.pointerType === "touch") {
          fingers.set(event.pointerId, event.clientX);
          if (fingers.size === 2) grip = held().map(place);
        } else if (event.button === 0) {
          from = {x: place(event.clientX), clientX: event.clientX};
          surface.setPointerCapture(event.pointerId);
        }
      });
      surface.addEventListener("pointerup", event => {
        const to = place(event.clientX), start = from;
        leave(event);
        if (start !== null && dragged) this.zoom(Math.min(start.x, to), Math.max(start.x, to));
      });
      surface.addEventListener("pointercancel", leave);
      surface.addEventListener("pointerleave", event => { if (from === null) { leave(event); this.cursor(null); } });
      // The end of a drag is no click.
      surface.addEventListener("click", event => { if (dragged) event.stopImmediatePropagation(); }, {capture: true});
      surface.addEventListener("dblclick", () => this.zoom());
      surface.addEventListener("wheel", event => {
        if (!event.ctrlKey) return;
        event.preventDefault();
        this.around(place(event.clientX), event.deltaY < 0 ? .8 : 1.25);
      }, {passive: false});
      element.addEventListener("keydown", event => {
        const [low, high] = drawing.range(), side = {ArrowLeft: -1, ArrowRight: 1}[event.key];
        const now = this.at ?? (low + high) / 2;
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        if (side && event.shiftKey) this.shift(side / 10);
        else if (side) this.cursor(Math.min(Math.max(this.next(now, side), low), high));
        else if (event.key === "+" || event.key === "=") this.around(now, .5);
        else if (event.key === "-") this.around(now, 2);
        else if (event.key === "0") this.zoom();
        else return;
        event.preventDefault();
      });
    }
  }

  return {View, shown, readout, rooms, decimals, before};
})();
