// What the pages with plots and a drawing share.

const THEMES = ["auto", "light", "dark"];
const get = (id) => document.getElementById(id);

function element(tag, text, attributes = {}) {
  const made = document.createElement(tag);
  if (text !== undefined) made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

// A button that shows a row under it and takes it away.
function disclose(button, row) {
  button.setAttribute("aria-controls", row.id);
  button.setAttribute("aria-expanded", "false");
  button.addEventListener("click", () => {
    row.hidden = !row.hidden;
    button.setAttribute("aria-expanded", String(!row.hidden));
  });
}

function complain(problem) {
  const text = problem instanceof Error ? `${problem.name}: ${problem.message}` : String(problem);
  get("trouble").textContent = `The page cannot go on (${text}).`;
  get("trouble").hidden = false;
}

// Take a theme, and say so on its button.
function applyTheme(theme) {
  if (theme === "auto") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  get("theme").textContent = { auto: "Auto", light: "Light", dark: "Dark" }[theme];
  get("theme").setAttribute("aria-label", `Theme: ${theme}`);
}

// The colours of the theme in force, from the style sheet.
function themeColours() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const actors = Array.from({ length: 8 }, (_, k) => colour(`result-${k}`));
  const paper = colour("paper");
  return {
    paper, ink: colour("ink"), muted: colour("muted"), grid: colour("grid"), curve: colour("curve"),
    actors, tints: actors.map((one) => mix(one, paper, 0.32)),
    font: "12px system-ui, sans-serif",
  };
}

// Actors whose points have no shape of their own are told apart by shape too.
function shaped(actor) {
  return actor.points.every(({ shape }) => !shape) ? "shaped" : "plain";
}

// An entry of the legend, which shows and hides its actor: switched(shown) is called.
function legendEntry(actor, switched) {
  const item = element("li"), dot = element("i", undefined, { "aria-hidden": "true", class: `dot ${shaped(actor)} c${actor.number % 8}` });
  const button = element("button", actor.label, { type: "button", class: "entry", "aria-pressed": "true", title: "Show or hide" });
  button.prepend(dot);
  button.addEventListener("click", () => {
    const shown = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", String(shown));
    switched(shown);
  });
  item.append(button);
  return item;
}

function mix(one, other, share) {
  const part = (hex, k) => parseInt(hex.slice(1 + 2 * k, 3 + 2 * k), 16);
  const blend = (k) => Math.round(part(one, k) * (1 - share) + part(other, k) * share);
  return `rgb(${blend(0)}, ${blend(1)}, ${blend(2)})`;
}
