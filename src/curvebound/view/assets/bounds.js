// The part of a y axis that shows most: a run that leaves all others behind does not flatten them.

const EARLY = 0.7;   // of the samples
const ALONE = 100;   // times what it spans early: then a run blows up at its end
const BESIDE = 8;    // times what the first run spans: then another leaves it behind

function extentOf(values, share = 1) {
  let low = Infinity, high = -Infinity;
  for (let k = 0; k < Math.ceil(values.length * share); k++) {
    if (values[k] < low) low = values[k];
    if (values[k] > high) high = values[k];
  }
  return [low, high];
}

// [low, high] for series of {label, values}, the reference's first; null where all is worth showing.
// `scale` is what a run beforehand spanned, of runs that go on: at rest until now, they may move at last.
function boundsOf(series) {
  const first = new Map();
  let low = Infinity, high = -Infinity, cut = false;
  for (const { label, values, scale } of series) {
    const whole = extentOf(values), early = extentOf(values, EARLY);
    let shown = whole;
    const widened = (extent, by, most) => {
      const span = extent[1] - extent[0];
      if (!(span > 0) || !(shown[1] - shown[0] > most * span)) return;
      shown = [Math.max(shown[0], extent[0] - by * span), Math.min(shown[1], extent[1] + by * span)];
      cut = true;
    };
    if (!scale) widened(early, 1, ALONE);
    if (first.has(label)) widened(first.get(label), 2, BESIDE);
    else first.set(label, scale ? [Math.min(shown[0], scale[0]), Math.max(shown[1], scale[1])] : shown);
    if (shown[0] < low) [low] = shown;
    if (shown[1] > high) [, high] = shown;
  }
  return cut && low < high ? [low, high] : null;
}
