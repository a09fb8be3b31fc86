// Curves over time. Of many samples in a pixel the extremes are drawn, so that no peak is lost.

/** A path through samples; NaN leaves a gap. */
function pathOf(times, values, axis, y) {
  let path = "";
  let gap = true;
  const put = (time, value) => {
    path += `${gap ? "M" : "L"}${axis.x(time).toFixed(1)} ${y(value).toFixed(1)}`;
    gap = false;
  };
  const dense = times.length > 2 * axis.width;
  let column = -1;
  let low = -1;
  let high = -1;
  const flush = () => {
    if (low < 0) return;
    const [first, second] = low <= high ? [low, high] : [high, low];
    put(times[first], values[first]);
    if (second !== first) put(times[second], values[second]);
    low = high = -1;
  };
  for (let i = 0; i < times.length; i++) {
    if (Number.isNaN(values[i])) {
      flush();
      gap = true;
      continue;
    }
    if (!dense) {
      put(times[i], values[i]);
      continue;
    }
    const at = Math.floor(axis.x(times[i]));
    if (at !== column) flush();
    column = at;
    if (low < 0 || values[i] < values[low]) low = i;
    if (high < 0 || values[i] > values[high]) high = i;
  }
  flush();
  return path;
}

/** The least and the greatest of some arrays; NaN is left out. */
function rangeOf(arrays, floor, ceiling) {
  let [low, high] = [floor ?? Infinity, ceiling ?? -Infinity];
  for (const values of arrays) {
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (!(low < high)) return [low === Infinity ? 0 : low - 0.5, (high === -Infinity ? 0 : high) + 0.5];
  return [low, high];
}

/** Of every run the same series: they are compared. */
const COMPARED = [
  { title: "e_s", unit: "0 is good", series: "e_s", floor: 0, height: 84, digits: 2 },
  {
    title: "REBA",
    unit: "hand at the tool",
    series: "REBA predicted",
    extra: "REBA measured",
    floor: 1,
    height: 84,
    digits: 0,
  },
  {
    title: "distance",
    unit: "m",
    series: "distance",
    group: "nearest",
    extra: "of the forearms",
    extraGroup: "nearest",
    floor: 0,
    limit: "protective distance",
    height: 64,
    digits: 2,
  },
  {
    title: "tool speed",
    unit: "mm/s",
    series: "speed of the tool",
    extra: "speed of the person",
    factor: 1000,
    floor: 0,
    height: 64,
    digits: 0,
  },
  {
    title: "tracking error",
    unit: "mm",
    series: "tracking error",
    factor: 1000,
    floor: 0,
    height: 56,
    digits: 1,
  },
];

/** Of the run that is looked at: the tool in its workspace. */
const PLACES = ["x", "y", "z"];

class Plots {
  constructor(parent, page) {
    this.page = page;
    this.compared = COMPARED.map((plot) => ({
      ...plot,
      track: new Track(parent, plot.title, plot.unit, plot.height),
    }));
    this.places = PLACES.map((axis) => ({ axis, track: new Track(parent, `tool ${axis}`, "m", 58) }));
    this.limits = new Limits(parent, page);
    this.times = new Track(parent, "time", "s", 22);
    this.known = page.runs.map(() => new Map());
  }

  values(run, column, group = "series", factor = 1) {
    const index = this.page.runs.indexOf(run);
    const key = `${group}/${column}`;
    const known = this.known[index];
    if (!known.has(key)) {
      const values = run.series(column, group);
      known.set(key, factor === 1 ? values : values.map((value) => value * factor));
    }
    return known.get(key);
  }

  draw(axis, current) {
    for (const plot of this.compared) this.drawCompared(plot, axis, current);
    for (const plot of this.places) this.drawPlace(plot, axis, current);
    this.limits.draw(axis, current);
    this.times.clear(axis);
    for (const time of axis.ticks()) {
      const x = axis.x(time);
      svg("line", { x1: x, x2: x, y1: 0, y2: 5, class: "tick" }, this.times.picture);
      const anchor = x < 12 ? "start" : x > axis.width - 12 ? "end" : "middle";
      svg("text", { x, y: 17, "text-anchor": anchor }, this.times.picture).textContent =
        `${+time.toFixed(3)}`;
    }
  }

  /** The frame of a plot: grid, numbers, and shades where person and robot work together. */
  frame(track, axis, [low, high], current, digits) {
    track.clear(axis);
    const { picture, height } = track;
    const room = 5;
    const y = (value) => height - room - ((value - low) / (high - low)) * (height - 2 * room);
    for (const [begin, end] of this.together(current)) {
      const x = axis.x(begin);
      svg("rect", { x, y: 0, width: Math.max(axis.x(end) - x, 0), height, class: "together" }, picture);
    }
    for (const time of axis.ticks()) {
      svg("line", { x1: axis.x(time), x2: axis.x(time), y1: 0, y2: height, class: "grid" }, picture);
    }
    for (const value of ticks(low, high, height / 26)) {
      svg("line", { x1: 0, x2: axis.width, y1: y(value), y2: y(value), class: "grid" }, picture);
      const label = svg(
        "text",
        { x: axis.width - 3, y: y(value) - 2.5, class: "number", "text-anchor": "end" },
        picture,
      );
      label.textContent = value.toFixed(Math.max(0, digits - (high - low >= 1 ? 1 : 0)));
    }
    return y;
  }

  together(run) {
    const values = this.values(run, "working together");
    const { times } = run.samples;
    const spans = [];
    values.forEach((value, i) => {
      if (value < 0.5) return;
      if (i > 0 && values[i - 1] > 0.5) spans.at(-1)[1] = times[i];
      else spans.push([times[i], times[i]]);
    });
    return spans;
  }

  drawCompared(plot, axis, current) {
    const { runs } = this.page;
    const of = (run, column, group) => this.values(run, column, group, plot.factor);
    const all = runs.map((run) => of(run, plot.series, plot.group));
    const extras = this.extras(plot).map(([column, group]) => of(current, column, group));
    const range = rangeOf([...all, ...extras], plot.floor);
    const y = this.frame(
      plot.track,
      axis,
      [range[0], range[1] + 0.06 * (range[1] - range[0])],
      current,
      plot.digits,
    );
    extras.forEach((values) => {
      svg("path", { d: pathOf(current.samples.times, values, axis, y), class: "extra" }, plot.track.picture);
    });
    const order = runs
      .map((run, index) => index)
      .sort((a, b) => (runs[a] === current) - (runs[b] === current));
    for (const index of order) {
      const path = pathOf(runs[index].samples.times, all[index], axis, y);
      const chosen = runs[index] === current ? " chosen" : "";
      svg("path", { d: path, class: `curve run-${index}${chosen}` }, plot.track.picture);
    }
  }

  /** Series that a plot has beside those that are compared, with their groups. */
  extras(plot) {
    return [[plot.extra, plot.extraGroup], [plot.limit]].filter(([column]) => column);
  }

  drawPlace({ axis: name, track }, axis, current) {
    const [low, high, desired, actual] = ["lower", "upper", "desired", "actual"].map((what) =>
      this.values(current, `${what} ${name}`),
    );
    const y = this.frame(track, axis, rangeOf([low, high, desired, actual]), current, 2);
    const { times } = current.samples;
    const there = pathOf(times, high, axis, y);
    const back = pathOf([...times].reverse(), [...low].reverse(), axis, y).replace(/^M/, "L");
    if (there && !there.slice(1).includes("M"))
      svg("path", { d: `${there}${back}Z`, class: "band" }, track.picture);
    svg("path", { d: pathOf(times, desired, axis, y), class: "desired" }, track.picture);
    const index = this.page.runs.indexOf(current);
    svg("path", { d: pathOf(times, actual, axis, y), class: `curve run-${index} chosen` }, track.picture);
  }

  /** Numbers at a time, in the headings. */
  show(current, time) {
    for (const plot of this.compared) {
      const texts = this.page.runs.map((run, index) => {
        const value = this.values(run, plot.series, plot.group, plot.factor)[run.samples.locate(time).row];
        return { text: written(value, plot.digits), index };
      });
      const row = current.samples.locate(time).row;
      const extra = this.extras(plot)
        .map(([column, group]) => ({
          text: written(this.values(current, column, group, plot.factor)[row], plot.digits),
          name: column,
        }))
        .filter(({ text, name }) => text !== "–" || name === plot.extra);
      showValues(plot.track.values, texts, extra);
    }
    const row = current.samples.locate(time).row;
    for (const { axis, track } of this.places) {
      track.values.textContent = written(this.values(current, `actual ${axis}`)[row], 3);
    }
    this.limits.show(current, time);
  }
}

function showValues(element, runs, extras) {
  if (element.childElementCount !== runs.length + extras.length) {
    element.replaceChildren();
    for (const { index } of runs) html("span", { class: `value run-${index}` }, element);
    for (const { name } of extras) html("span", { class: "value extra", title: name }, element);
  }
  [...runs, ...extras].forEach(({ text }, k) => {
    element.children[k].textContent = text;
  });
}
