// The axis of time that lanes and plots have in common.

/** Round numbers from low to high, about `count` of them. */
function ticks(low, high, count) {
  const rough = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((size) => size >= rough) ?? 10 * power;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return found;
}

class TimeAxis {
  constructor(begin, end) {
    this.begin = begin;
    this.end = Math.max(end, begin + 1e-3);
    this.width = 600;
  }

  x(time) {
    return ((time - this.begin) / (this.end - this.begin)) * this.width;
  }

  time(x) {
    const share = Math.min(Math.max(x / this.width, 0), 1);
    return this.begin + share * (this.end - this.begin);
  }

  ticks() {
    return ticks(this.begin, this.end, Math.max(2, this.width / 75));
  }
}

/** A row of the tracks: a heading on the left and a picture of SVG over time. */
class Track {
  constructor(parent, title, unit, height) {
    this.row = html("div", { class: "track" }, parent);
    this.head = html("div", { class: "head" }, this.row);
    const name = html("div", { class: "name", text: title }, this.head);
    if (unit) html("span", { class: "unit", text: ` ${unit}` }, name);
    this.values = html("div", { class: "values" }, this.head);
    this.height = height;
    this.picture = svg("svg", { class: "picture", height, role: "img", "aria-label": title }, this.row);
  }

  clear(axis) {
    this.picture.replaceChildren();
    this.picture.setAttribute("viewBox", `0 0 ${axis.width} ${this.height}`);
    this.picture.setAttribute("width", axis.width);
  }
}
