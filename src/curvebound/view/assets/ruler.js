// Lines and a bar that tell the scale of a drawing.

// The length of 1, 2 or 5 times a power of ten nearest above `pixels`.
function ruleOf(camera, pixels) {
  const least = pixels / camera.scale, power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((k) => k * power >= least * 0.999999);
}

function drawGrid(c, { width, height }, camera, colours) {
  const step = ruleOf(camera, 70);
  const first = Math.ceil(-camera.left / camera.scale / step);
  const last = Math.floor((width - camera.left) / camera.scale / step);
  const low = Math.ceil((camera.bottom - height) / camera.scale / step);
  const high = Math.floor(camera.bottom / camera.scale / step);
  c.lineWidth = 1;
  c.strokeStyle = colours.grid;
  c.beginPath();
  for (let k = first; k <= last; k++) {
    const x = Math.round(camera.left + k * step * camera.scale) + 0.5;
    c.moveTo(x, 0);
    c.lineTo(x, height);
  }
  for (let k = low; k <= high; k++) {
    const y = Math.round(camera.bottom - k * step * camera.scale) + 0.5;
    c.moveTo(0, y);
    c.lineTo(width, y);
  }
  c.stroke();
}

function drawScaleBar(c, { width, height }, camera, colours) {
  const length = ruleOf(camera, 60), pixels = length * camera.scale;
  const x = width - 16 - pixels, y = height - 16;
  c.strokeStyle = c.fillStyle = colours.muted;
  c.lineWidth = 1.5;
  c.beginPath();
  c.moveTo(x, y - 4);
  c.lineTo(x, y);
  c.lineTo(x + pixels, y);
  c.lineTo(x + pixels, y - 4);
  c.stroke();
  c.font = colours.font;
  c.textAlign = "center";
  c.fillText(`${tickText(length)} m`, x + pixels / 2, y - 7);
}
