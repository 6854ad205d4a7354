// The part of the plane that a live scene shows: that of the run beforehand, and where bodies have been since.

const LATELY = 1200;     // samples
const LEFT_BEHIND = 4;   // times what the first run covers: then another does not shrink it
const MARGIN = 0.05;     // of a box that what has moved has grown

// Curves without ends reach as far as the point that they hold has gone.
function growCurves({ scene, placed }) {
  scene.actors.forEach((actor, k) => {
    for (const { holds, drawn } of actor.growing) {
      const reach = 1.15 * Math.abs(placed[k].point(holds)[0] - placed[k].point("frame")[0]);
      if (reach > drawn.s[1] && Number.isFinite(reach)) drawn.s = [-reach, reach];
    }
  });
}

// {world, frame} of what all actors need, or those of the first run; as the model's view.
function boxesOf({ model, samples, scene }, all) {
  const given = all ? model.view.all ?? model.view : model.view, boxes = {};
  for (const kind of ["world", "frame"]) {
    const box = [...given[kind]];
    for (const { run, points, sources } of scene.actors.filter((actor) => all || actor.run === 0)) {
      const { length } = samples[run];
      for (const [name, axis] of points.flatMap((point) => [[point.name, 0], [point.name, 1]])) {
        const values = sources[`${name} ${"xy"[axis]}`], origin = sources[`frame ${"xy"[axis]}`];
        for (let k = Math.max(length - LATELY, 0); k < length; k++) {
          const value = values[k] - (kind === "frame" ? origin[k] : 0);
          if (!Number.isFinite(value)) continue;
          box[axis] = Math.min(box[axis], value);
          box[axis + 2] = Math.max(box[axis + 2], value);
        }
      }
    }
    const pad = given[kind].every((end, k) => end === box[k]) ? 0 : MARGIN * sizeOf(box);
    boxes[kind] = box.map((end, k) => (end === given[kind][k] ? end : end + (k < 2 ? -pad : pad)));
  }
  return boxes;
}

function sizeOf([x0, y0, x1, y1]) {
  return Math.max(x1 - x0, y1 - y0);
}

// A box, no farther from the first run's than that is large, where it is much larger.
function heldBox(box, first) {
  const size = sizeOf(first);
  if (sizeOf(box) <= LEFT_BEHIND * size) return box;
  return box.map((end, k) => (k < 2 ? Math.max(end, first[k] - size) : Math.min(end, first[k] + size)));
}

// What "Fit" shows.
function fittedView(page) {
  const all = boxesOf(page, true), first = boxesOf(page, false);
  return { ...page.model.view, world: heldBox(all.world, first.world), frame: heldBox(all.frame, first.frame) };
}

// What "See all" shows; undefined where nothing has left what the view shows.
function allOf(page, view) {
  const all = boxesOf(page, true);
  const within = (box, shown) => box.every((end, k) => (k < 2 ? end >= shown[k] : end <= shown[k]));
  return within(all.world, view.world) && within(all.frame, view.frame) ? undefined : all;
}
