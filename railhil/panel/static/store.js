// The rows of one run: preallocated typed arrays, older rows half as dense when they are full.
const ROWS_MAX = 48000;

export class Store {
  // position: place of its column, -1 if there is none.
  constructor(columns, position) {
    this.position = position;
    this.times = new Float64Array(ROWS_MAX);
    this.values = Array.from({ length: columns }, () => new Float32Array(ROWS_MAX));
    this.rows = 0;
    // Whether a column has had a value other than 0.
    this.told = this.values.map(() => false);
  }

  // A batch as railhil.panel.wire writes it, without its first four numbers.
  take(replace, buffer, rows, columns) {
    if (replace) this.rows = 0;
    const times = new Float64Array(buffer, 16, rows);
    const values = new Float32Array(buffer, 16 + 8 * rows, rows * columns);
    this.told.forEach((is, at) => {
      if (!is) this.told[at] = values.subarray(at * rows, (at + 1) * rows).some((value) => value && !Number.isNaN(value));
    });
    for (let from = 0; from < rows;) {
      if (this.rows === ROWS_MAX) this.halve();
      const count = Math.min(rows - from, ROWS_MAX - this.rows);
      this.times.set(times.subarray(from, from + count), this.rows);
      this.values.forEach((column, at) => {
        column.set(values.subarray(at * rows + from, at * rows + from + count), this.rows);
      });
      this.rows += count;
      from += count;
    }
  }

  halve() {
    for (let row = 0; row < ROWS_MAX / 2; row += 1) {
      const from = this.isGap(2 * row + 1) ? 2 * row + 1 : 2 * row;
      for (const column of [this.times, ...this.values]) column[row] = column[from];
    }
    this.rows = ROWS_MAX / 2;
  }

  // Nothing is known but time and position.
  isGap(row) { return this.values.every((column, at) => at === this.position || Number.isNaN(column[row])); }

  get endS() { return this.rows ? this.times[this.rows - 1] : 0; }

  // Last row at or before an instant; -1: none.
  rowAt(timeS) { return railhilView.before(this.times, timeS, this.rows) - 1; }
}

// Smallest and largest value of each of `count` parts of an increasing x, two points a part; all series share the x.
export function thinned(x, series, from, to, count) {
  if (to - from <= 2 * count) return [x.subarray(from, to), ...series.map((one) => one.subarray(from, to))];
  const step = (to - from) / count;
  const found = [new Float64Array(2 * count), ...series.map(() => new Float32Array(2 * count))];
  for (let part = 0; part < count; part += 1) {
    const begin = from + Math.floor(part * step), end = from + Math.floor((part + 1) * step);
    found[0][2 * part] = x[begin];
    found[0][2 * part + 1] = x[end - 1];
    series.forEach((one, at) => {
      let low = Infinity, high = -Infinity, lowAt = begin, highAt = begin, gap = false;
      for (let row = begin; row < end; row += 1) {
        const value = one[row];
        gap ||= Number.isNaN(value);
        if (value < low) { low = value; lowAt = row; }
        if (value > high) { high = value; highAt = row; }
      }
      const known = high >= low;
      // A gap remains one, whatever else the part has.
      if (gap) { found[at + 1][2 * part] = known ? low : NaN; found[at + 1][2 * part + 1] = NaN; return; }
      found[at + 1][2 * part] = known ? (lowAt <= highAt ? low : high) : NaN;
      found[at + 1][2 * part + 1] = known ? (lowAt <= highAt ? high : low) : NaN;
    });
  }
  return found;
}
