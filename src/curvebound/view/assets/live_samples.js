// The samples of one run that the page still holds: a part of the past, at most so many rows.

const CAPACITY = 16384;

class Samples {
  // run: as the server tells it, with its actors; columns: how many outputs a row has.
  constructor(run, columns) {
    this.length = 0;
    this.pushed = 0;  // rows in all
    this.columns = Array.from({ length: columns + 1 }, () => new Float64Array(CAPACITY));
    this.times = this.columns[0];
    this.derived = [];
    this.actors = run.actors.map((actor) => this.placed(actor));
  }

  // What an actor's drawing needs, by name: columns, constants, and what its formulas give.
  placed(actor) {
    const places = {};
    for (const [name, { column, value }] of Object.entries(actor.names)) {
      places[name] = column === undefined ? new Float64Array(CAPACITY).fill(value)
        : this.columns[column + 1];
    }
    // The variables of the row that is being pushed, once for all formulas.
    const sources = Object.entries(places), values = {};
    let pushed = -1;
    const row = (k) => {
      if (pushed !== this.pushed) for (const [name, source] of sources) values[name] = source[k];
      pushed = this.pushed;
      return values;
    };
    const channel = (tree) => {
      const apply = formula(tree);
      return this.derive((k) => apply(row(k)));
    };
    for (const [point, { x, y }] of Object.entries(actor.formulas)) {
      places[`${point} x`] = channel(x);
      places[`${point} y`] = channel(y);
    }
    const arrows = actor.arrows.map(({ kind, at, x, y }) => ({ kind, at, sources: [channel(x), channel(y)] }));
    return { ...actor, places, arrows };
  }

  // A channel that follows from the others: of(k) is its value in row k.
  derive(of) {
    const values = new Float64Array(CAPACITY);
    this.derived.push({ values, of });
    return values;
  }

  get last() {
    return this.length ? this.times[this.length - 1] : NaN;
  }

  push(row) {
    if (this.length && row[0] <= this.last) this.cut(row[0], false);
    if (this.length === CAPACITY) this.forget(CAPACITY / 4);
    const k = this.length;
    this.pushed++;
    for (let i = 0; i < this.columns.length; i++) this.columns[i][k] = row[i];
    for (const { values, of } of this.derived) values[k] = of(k);
    this.length = k + 1;
  }

  // Drop the oldest rows.
  forget(count) {
    for (const values of [...this.columns, ...this.derived.map((one) => one.values)]) {
      values.copyWithin(0, count);
    }
    this.length -= count;
  }

  // Drop what is later than a time, or that too.
  cut(time, keeping = true) {
    while (this.length && (this.last > time || (!keeping && this.last === time))) this.length--;
  }

  view(values) {
    return values.subarray(0, this.length);
  }
}
