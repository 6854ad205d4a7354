// Series with more samples than pixels: at most two points a column, so that length costs nothing.

// Aligned data for uPlot: x, then one array a series. Where a series has more samples than pixels,
// the least and the greatest of each column of pixels stand for all of them.
function decimate(series, from, to, columns) {
  const parts = series.map(({ times }) => {
    const first = Math.max(indexAt(times, from) - 1, 0);
    return [first, Math.min(indexAt(times, to) + 2, times.length)];
  });
  if (parts.some(([first, end]) => end - first > 2 * columns)) {
    return minMax(series, parts, from, to, columns);
  }
  const tables = series.map(({ times, values }, k) => {
    const [first, end] = parts[k];
    return [Array.from(times.subarray(first, end)), blanks(values.subarray(first, end))];
  });
  return tables.length === 1 ? tables[0] : uPlot.join(tables, tables.map(() => [2]));
}

function blanks(values) {
  return Array.from(values, (value) => (Number.isFinite(value) ? value : null));
}

// The columns begin at whole multiples of their width, so that a line that moves does not shimmer.
function minMax(series, parts, left, to, most) {
  const width = (to - left) / most, from = Math.floor(left / width) * width, columns = most + 1;
  const xs = new Array(2 * columns);
  for (let k = 0; k < columns; k++) {
    xs[2 * k] = from + (k + 0.25) * width;
    xs[2 * k + 1] = from + (k + 0.75) * width;
  }
  return [xs, ...series.map(({ times, values }, at) => {
    // Undefined is no data here, drawn across; null is a gap.
    const out = new Array(2 * columns), [first, end] = parts[at];
    let i = first;
    for (let k = 0; k < columns; k++) {
      const stop = from + (k + 1) * width;
      let low = Infinity, high = -Infinity, lowAt = 0, highAt = 0, gap = false;
      for (; i < end && (times[i] < stop || k === columns - 1); i++) {
        const value = values[i];
        if (!Number.isFinite(value)) { gap = true; continue; }
        if (value < low) { low = value; lowAt = i; }
        if (value > high) { high = value; highAt = i; }
      }
      if (high >= low) {
        out[2 * k] = lowAt <= highAt ? low : high;
        out[2 * k + 1] = lowAt <= highAt ? high : low;
      } else if (gap) out[2 * k] = out[2 * k + 1] = null;
    }
    return out;
  })];
}

const ROUGH = 0.08;  // of the points are turns of a line that goes up and down within few columns

// The lines of a series, from u's data. A rough one takes long to stroke, and longest where it is
// dashed, but fills its columns anyway: it gets thin and solid.
function lineOf({ width, dash }) {
  const straight = uPlot.paths.linear();
  return (u, k, from, to) => {
    const values = u.data[k], scale = u.series[k].scale;
    let way = 0, turns = 0, before = null, step = 0;
    for (let i = from; i <= to; i++) {
      if (typeof values[i] !== "number") continue;
      const y = u.valToPos(values[i], scale, true), next = before === null ? 0 : y - before;
      if (next * step < 0) turns++;
      way += Math.abs(next);
      if (next) step = next;
      before = y;
    }
    const rough = turns > ROUGH * (to - from) && way > u.bbox.width;
    // pxAlign puts the edges of uPlot's clipping on whole pixels, without which it takes long too
    const thin = { width: 1 / devicePixelRatio, dash: [], pxAlign: 1 };
    Object.assign(u.series[k], rough ? thin : { width, dash, pxAlign: 0 });
    return straight(u, k, from, to);
  };
}
