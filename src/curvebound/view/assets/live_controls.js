// What can be changed: ranges at once, settings with a restart.

let fields = 0;

function labelled(one, name, input) {
  const id = `field-${fields++}`, box = element("div", undefined, { class: "control" });
  const label = element("label", name, { for: id }), unit = prettyUnit(one.unit);
  if (unit) label.append(" ", element("span", unit, { class: "unit" }));
  const words = one.description + (one.added ? "; adds to what the scene gives" : "");
  input.id = id;
  input.setAttribute("aria-describedby", `${id}-words`);
  box.append(label, input);
  return { box, words: element("p", words, { class: "words", id: `${id}-words` }) };
}

function choice(items) {
  const select = element("select");
  for (const [name, value] of Object.entries(items)) select.append(element("option", name, { value }));
  return select;
}

// Headings where a new component begins.
function grouped(parent, list, build) {
  const components = new Set(list.map(({ path }) => path.split(".")[0]));
  let before = "";
  for (const one of list) {
    const component = one.path.includes(".") ? one.path.split(".")[0] : "";
    const plain = component ? one.path.slice(component.length + 1) : one.path;
    if (component !== before && components.size > 1) {
      parent.append(element("h3", component || "scene"));
      before = component;
    }
    parent.append(build(one, plain));
  }
}

// Range inputs, and a box for any value; send(path, value) is called as they move.
class Ranges {
  constructor(parent, controls, send) {
    this.shown = new Map();
    this.waiting = new Map();
    this.send = send;
    grouped(parent, controls, (one, name) => this.build(one, name));
    if (!controls.length) parent.append(element("p", "Nothing in this scene can be changed while it runs."));
  }

  build(one, name) {
    if (one.items || one.kind === "Boolean") {
      const select = choice(one.items ?? { false: 0, true: 1 });
      select.addEventListener("change", () => this.change(one.path, Number(select.value)));
      const { box, words } = labelled(one, name, select);
      box.append(words);
      this.shown.set(one.path, { show: (value) => { select.value = String(value); } });
      this.shown.get(one.path).show(Number(one.value));
      return box;
    }
    const number = element("input", undefined, { type: "number", step: "any" });
    const { box, words } = labelled(one, name, number);
    const range = element("input", undefined, {
      type: "range", min: one.low, max: one.high, step: one.kind === "Integer" ? 1 : "any", "aria-label": one.path,
    });
    range.addEventListener("input", () => {
      const value = this.rounded(range, one);
      number.value = value;
      this.change(one.path, value);
    });
    range.addEventListener("dblclick", () => this.change(one.path, one.value));
    number.addEventListener("change", () => {
      if (number.value !== "") this.change(one.path, Number(number.value));
    });
    box.append(range, words);
    const show = (value) => {
      if (value < Number(range.min)) range.min = value;
      if (value > Number(range.max)) range.max = value;
      if (document.activeElement !== range) range.value = value;
      if (document.activeElement !== number) number.value = Number(value.toPrecision(6));
    };
    this.shown.set(one.path, { show });
    show(one.value);
    return box;
  }

  // A four-hundredth of the range, so that zero and round numbers are met.
  rounded(range, one) {
    const value = Number(range.value);
    if (one.kind === "Integer") return Math.round(value);
    const grain = 10 ** Math.floor(Math.log10((Number(range.max) - Number(range.min)) / 100));
    return Number((Math.round(value / grain) * grain).toPrecision(12));
  }

  // One message a picture and variable is enough.
  change(path, value) {
    if (!this.waiting.size) requestAnimationFrame(() => this.flush());
    this.waiting.set(path, value);
  }

  flush() {
    for (const [path, value] of this.waiting) this.send(path, value);
    this.waiting.clear();
  }

  show(values) {
    for (const [path, value] of Object.entries(values)) {
      if (!this.waiting.has(path)) this.shown.get(path)?.show(value);
    }
  }
}

// Start values and settings, as texts: pi/2 and 90deg are understood.
class Settings {
  // on: {restart(settings), original(), beside(label, settings), variant(name)}.
  constructor(form, settings, variants, on) {
    this.fields = settings.map((one) => ({ one, first: this.text(one), input: this.input(one) }));
    grouped(form, settings, (one, name) => {
      const { input } = this.fields.find((field) => field.one === one);
      const { box, words } = labelled(one, name, input);
      box.append(words);
      return box;
    });
    const buttons = element("div", undefined, { class: "buttons" });
    const button = (text, action, type = "button") => {
      const made = element("button", text, { type });
      made.addEventListener("click", action);
      buttons.append(made);
    };
    button("Restart with these", () => {}, "submit");
    button("Beside with these", () => on.beside(this.label(), this.changed()));
    button("As the scene has them", () => on.original());
    for (const name of variants) button(`Beside: ${name}`, () => on.variant(name));
    form.append(buttons);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      on.restart(this.changed());
    });
  }

  text(one) {
    if (!one.items) return String(one.value);
    return Object.keys(one.items).find((name) => one.items[name] === one.value);
  }

  input(one) {
    const input = one.items ? choice(Object.fromEntries(Object.keys(one.items).map((name) => [name, name])))
      : element("input", undefined, { type: "text", inputmode: "text", spellcheck: "false" });
    input.value = this.text(one);
    return input;
  }

  // What differs from the scene, by path.
  changed() {
    const differing = this.fields.filter(({ input, first }) => input.value.trim() !== first);
    return Object.fromEntries(differing.map(({ one, input }) => [one.path, input.value.trim()]));
  }

  label() {
    const parts = Object.entries(this.changed()).map(([path, value]) => `${path.split(".").slice(-1)} ${value}`);
    return (parts.slice(0, 2).join(", ") || "the same again").slice(0, 60);
  }

  show(settings) {
    for (const { one, first, input } of this.fields) input.value = settings[one.path] ?? first;
  }
}
