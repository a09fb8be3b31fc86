// Reads the data that the page holds.

/** The bytes of a text in base64. */
function bytesOf(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** Columns that belong together: `rows` numbers a sample, NaN where one is not known. */
class Group {
  constructor(data, count) {
    this.columns = data.columns;
    this.size = data.size;
    this.width = data.columns.length * data.size;
    this.count = count;
    this.data = data;
  }

  /** All numbers, row by row; decoded when they are first asked for. */
  get values() {
    const { data, count, width } = this;
    const bytes = bytesOf(data.data);
    let values = null;
    if (data.step.length === 0) {
      values = new Float32Array(bytes.buffer);
    } else {
      const steps = new Uint16Array(bytes.buffer);
      values = new Float32Array(steps.length);
      for (let i = 0; i < steps.length; i++) {
        const column = i % width;
        values[i] = steps[i] === 65535 ? NaN : data.low[column] + data.step[column] * steps[i];
      }
    }
    if (values.length !== count * width) throw new Error("the data of the page are cut");
    Object.defineProperty(this, "values", { value: values });
    this.data = null;
    return values;
  }

  index(column) {
    return this.columns.indexOf(column) * this.size;
  }

  get(row, place) {
    return this.values[row * this.width + place];
  }
}

/** Rows of groups over time. */
class Table {
  constructor(data) {
    this.count = data.count;
    this.times = new Float64Array(bytesOf(data.times).buffer);
    this.groups = {};
    for (const group of data.groups) this.groups[group.name] = new Group(group, data.count);
  }

  /** The row at a time or before it, and how far the time is on the way to the next. */
  locate(time) {
    const { times, count } = this;
    if (count === 0 || !(time > times[0])) return { row: 0, next: 0, share: 0 };
    if (time >= times[count - 1]) return { row: count - 1, next: count - 1, share: 0 };
    let low = 0;
    let high = count - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= time) low = middle;
      else high = middle;
    }
    return { row: low, next: high, share: (time - times[low]) / (times[high] - times[low]) };
  }
}

/** A run: its samples, what the camera saw, and its states. */
class Run {
  constructor(data) {
    this.title = data.title;
    this.solids = data.solids;
    this.samples = new Table(data.samples);
    this.person = new Table(data.person);
    this.others = data.others ? new Table(data.others) : null;
    this.lanes = data.lanes;
    this.begin = this.samples.times[0];
    this.end = this.samples.times[this.samples.count - 1];
  }

  /** A series as an array over the samples; `column` is its name. */
  series(column, group = "series") {
    const of = this.samples.groups[group];
    const place = of.index(column);
    const values = new Float32Array(this.samples.count);
    for (let row = 0; row < values.length; row++) {
      values[row] = place < 0 ? NaN : of.get(row, place);
    }
    return values;
  }

  /** The number of a series in the sample at a time. */
  at(time, column, group = "series") {
    const of = this.samples.groups[group];
    return of.get(this.samples.locate(time).row, of.index(column));
  }
}

/** A point between two rows, into `out`; false where it is not known. */
function pointAt(group, place, at, out) {
  for (let k = 0; k < 3; k++) {
    const first = group.get(at.row, place + k);
    const second = group.get(at.next, place + k);
    out[k] = Number.isNaN(second) ? first : first + (second - first) * at.share;
  }
  return !Number.isNaN(out[0]);
}

/** Everything that the page holds. */
function readPage() {
  const data = JSON.parse(document.getElementById("data").textContent);
  const runs = data.runs.map((run) => new Run(run));
  return { ...data, runs, begin: runs[0].begin, end: Math.max(...runs.map((run) => run.end)) };
}
