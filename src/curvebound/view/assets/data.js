// Unpacks the embedded samples (see view/packing.py) and reads values between them.

// The deflated planes of bytes, from base64 in the element `id`.
async function unpack(id) {
  const text = atob(document.getElementById(id).textContent.trim());
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Every channel as a Float64Array, NaN where there was no number.
function decodeChannels(channels, bytes) {
  let start = 0;
  return channels.map((channel) => {
    const values = new Float64Array(channel.samples);
    if (channel.kind === "constant") return values.fill(channel.value ?? NaN);
    decode(channel, bytes.subarray(start, start + channel.samples * channel.bytes), values);
    start += channel.samples * channel.bytes;
    return values;
  });
}

function decode(channel, planes, values) {
  const n = channel.samples, modulus = 2 ** (8 * channel.bytes);
  for (let plane = channel.bytes - 1; plane >= 0; plane--) {
    for (let i = 0, at = plane * n; i < n; i++, at++) values[i] = values[i] * 256 + planes[at];
  }
  for (let pass = 0; pass < channel.order; pass++) {
    for (let i = 1; i < n; i++) {
      const sum = values[i - 1] + values[i];
      values[i] = sum >= modulus ? sum - modulus : sum;
    }
  }
  if (channel.kind === "float") {
    const bits = new Uint32Array(1), single = new Float32Array(bits.buffer);
    for (let i = 0; i < n; i++) {
      bits[0] = values[i] * 256;
      values[i] = single[0];
    }
  } else {
    const none = modulus - 1;
    for (let i = 0; i < n; i++) {
      values[i] = values[i] === none ? NaN : channel.low + values[i] * channel.step;
    }
  }
}

// Index of the last sample at or before t, 0 where all are later.
function indexAt(times, t) {
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle; else high = middle - 1;
  }
  return low;
}

// Whether t lies within the times of samples, but for rounding: t may be the time of another run's
// sample, which packing moves by up to 5e-13 of that run's length; longest: that of all runs, in s.
function during(times, t, longest = 0) {
  const first = times[0], last = times[times.length - 1];
  const rounding = 1e-12 * Math.max(Math.abs(first), Math.abs(last), longest);
  return t >= first - rounding && t <= last + rounding;
}

// Index of the sample nearest to t.
function nearestIndex(times, t) {
  const i = indexAt(times, t);
  return i + 1 < times.length && times[i + 1] - t < t - times[i] ? i + 1 : i;
}

// Value at time t: exact at a sample, between two a cubic through them with the slopes of their
// neighbourhood, so that a coarse output interval still moves on a curve. NaN next to a gap.
function valueAt(times, values, i, t) {
  const t0 = times[i], last = times.length - 1;
  if (i >= last || t <= t0) return values[i];
  const h = times[i + 1] - t0, s = Math.min((t - t0) / h, 1);
  const v0 = values[i], v1 = values[i + 1];
  if (s === 0) return v0;
  if (s === 1) return v1;
  const straight = (v1 - v0) / h;
  let m0 = slope(times, values, i), m1 = slope(times, values, i + 1);
  // Without a neighbour on one side a quadratic, without any a straight line.
  if (Number.isNaN(m0)) m0 = Number.isNaN(m1) ? straight : 2 * straight - m1;
  if (Number.isNaN(m1)) m1 = 2 * straight - m0;
  const r = 1 - s;
  return (1 + 2 * s) * r * r * v0 + s * s * (3 - 2 * s) * v1 + h * s * r * (r * m0 - s * m1);
}

// That of the quadratic through a sample and its neighbours, NaN where it lacks one.
function slope(times, values, i) {
  if (i === 0 || i === times.length - 1) return NaN;
  const before = times[i] - times[i - 1], after = times[i + 1] - times[i];
  if (!(before > 0 && after > 0)) return NaN;
  const rise = (values[i] - values[i - 1]) / before, fall = (values[i + 1] - values[i]) / after;
  return (rise * after + fall * before) / (before + after);
}
