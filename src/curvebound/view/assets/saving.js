// Pictures of the page as PNG files.

function download(canvas, name) {
  const link = element("a", undefined, { href: canvas.toDataURL("image/png"), download: `${name}.png` });
  link.click();
}

function fileName(...parts) {
  return parts.join(" ").replaceAll(/[^\p{L}\p{N}]+/gu, "_").replaceAll(/^_|_$/g, "");
}

// A plot on paper, with its title above and its legend below.
function plotPicture(plot, colours) {
  const source = plot.chart.ctx.canvas, ratio = source.width / plot.chart.width;
  const canvas = element("canvas"), line = 20, c = canvas.getContext("2d");
  const shown = plot.lines.filter((one) => plot.shows(one));
  canvas.width = source.width;
  canvas.height = source.height + ratio * (32 + line * shown.length);
  c.fillStyle = colours.paper;
  c.fillRect(0, 0, canvas.width, canvas.height);
  c.drawImage(source, 0, 26 * ratio);
  c.scale(ratio, ratio);
  c.fillStyle = colours.ink;
  c.font = `600 14px system-ui, sans-serif`;
  c.fillText(plot.heading(), 12, 19);
  c.font = colours.font;
  shown.forEach((one, k) => {
    const y = 26 + plot.chart.height + line * k + 12;
    c.strokeStyle = one.colour();
    c.lineWidth = 2;
    c.setLineDash(one.dash);
    c.beginPath();
    c.moveTo(12, y - 4);
    c.lineTo(36, y - 4);
    c.stroke();
    c.fillText(one.text, 44, y);
  });
  return canvas;
}
