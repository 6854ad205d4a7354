// Numbers and units as text, always the same width for the same quantity so that they do not jump.

const MINUS = "\u2212";

function prettyUnit(unit) {
  if (unit === "1" || !unit) return "";
  return unit.replace(/([a-zA-Z])2/g, "$1\u00b2").replaceAll(".", "\u00b7");
}

function withUnit(text, unit) {
  const pretty = prettyUnit(unit);
  return pretty && text !== "\u2013" ? `${text} ${pretty}` : text;
}

// A formatter for a signal: as many decimals as show 1e-5 of its greatest magnitude, none for what
// counts, three significant digits for an error.
function formatter(values, error) {
  let largest = 0, counts = true;
  for (const value of values) {
    const size = Math.abs(value);
    if (size > largest) largest = size;
    if (counts && !Number.isInteger(value)) counts = false;
  }
  const whole = Math.floor(Math.log10(largest));
  const decimals = counts ? 0 : Math.min(Math.max(4 - whole, 0), 8);
  const plain = !error && ((whole >= -4 && whole <= 6) || (counts && whole < 15));
  return (value) => {
    if (!Number.isFinite(value)) return "\u2013";
    if (value === 0 && !plain) return "0";
    const size = Math.abs(value);
    const text = plain ? value.toFixed(decimals)
      : error && size >= 0.01 && size < 1000 ? value.toPrecision(3)
        : value.toExponential(error ? 2 : 4).replace("e+", "e");
    return text.replaceAll("-", MINUS);
  };
}

const DEGREE = 180 / Math.PI;

// The unit in degrees of one in radians, else null.
function degreesOf(unit) {
  return { rad: "\u00b0", "rad/s": "\u00b0/s", "rad/s2": "\u00b0/s2" }[unit] ?? null;
}

// A value with its unit: as it is, or in the unit in degrees that it is turned into.
function told({ format, unit }, value, turned) {
  if (!turned) return withUnit(format(value), unit);
  return Number.isFinite(value) ? withUnit((value * DEGREE).toFixed(2).replace("-", MINUS), turned) : "\u2013";
}

// Labels of an axis: plain where short, else with an exponent.
function tickText(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3) {
    return value.toExponential(3).replace(/\.?0+e/, "e").replace("e+", "e").replaceAll("-", MINUS);
  }
  return String(Number(value.toPrecision(8))).replace("-", MINUS);
}

// A formatter of times with the decimals that tell samples apart.
function timeFormatter(times) {
  const n = times.length;
  const step = n > 1 ? (times[n - 1] - times[0]) / (n - 1) : 1;
  const decimals = step > 0 ? Math.min(Math.max(Math.ceil(-Math.log10(step)), 1), 6) : 3;
  return (t) => t.toFixed(Math.max(decimals, 2));
}
