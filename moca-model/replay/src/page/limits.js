// How much of each limit is used: a row a limit, darker the nearer it is to its bound.

const AT_BOUND = 0.999;

class Limits {
  constructor(parent, page) {
    this.names = page.runs[0].samples.groups.limits.columns;
    this.step = 7;
    this.track = new Track(parent, "limits in use", "", this.names.length * this.step + 4);
    this.track.row.classList.add("limits");
    this.canvas = document.createElement("canvas");
  }

  draw(axis, run) {
    const { track, step, names, canvas } = this;
    track.clear(axis);
    const group = run.samples.groups.limits;
    // A pixel of the picture a cell: the greatest share of the samples in it.
    const columns = Math.max(1, Math.round(axis.width));
    canvas.width = columns;
    canvas.height = names.length;
    const most = new Float32Array(columns * names.length);
    const { times } = run.samples;
    for (let row = 0; row < times.length; row++) {
      const from = Math.min(columns - 1, Math.floor(axis.x(times[row])));
      const next = row + 1 < times.length ? axis.x(times[row + 1]) : axis.x(times[row]);
      for (
        let column = from;
        column <= Math.min(columns - 1, Math.max(from, Math.ceil(next) - 1));
        column++
      ) {
        for (let k = 0; k < names.length; k++) {
          const share = group.get(row, k);
          if (share > most[k * columns + column]) most[k * columns + column] = share;
        }
      }
    }
    const painter = canvas.getContext("2d");
    const image = painter.createImageData(columns, names.length);
    const [light, dark, bound] = ["--limit-low", "--limit-high", "--limit-bound"].map(themeColour);
    most.forEach((share, i) => {
      const colour =
        share >= AT_BOUND ? bound : light.map((low, k) => low + (dark[k] - low) * Math.min(share, 1) ** 2);
      colour.forEach((value, k) => (image.data[4 * i + k] = 255 * value));
      image.data[4 * i + 3] = 255;
    });
    painter.putImageData(image, 0, 0);
    const height = names.length * step;
    svg(
      "image",
      {
        href: canvas.toDataURL(),
        x: 0,
        y: 2,
        width: axis.width,
        height,
        preserveAspectRatio: "none",
        class: "cells",
      },
      track.picture,
    );
    this.drawKinds(axis);
    names.forEach((name, k) => {
      const row = svg(
        "rect",
        { x: 0, y: 2 + k * step, width: axis.width, height: step, class: "over cell" },
        track.picture,
      );
      svg("title", {}, row).textContent = name;
    });
  }

  /** What the rows are of, beside the first of each kind. */
  drawKinds(axis) {
    const kind = (name) => name.split(" ").at(-1);
    this.names.forEach((name, k) => {
      if (k > 0 && kind(name) === kind(this.names[k - 1])) return;
      const y = 2 + k * this.step;
      if (k > 0) svg("line", { x1: 0, x2: axis.width, y1: y, y2: y, class: "kind" }, this.track.picture);
      const label = svg(
        "text",
        { x: axis.width - 3, y: y + 10, class: "number", "text-anchor": "end" },
        this.track.picture,
      );
      label.textContent =
        kind(name) === "turning" ? "" : name.startsWith("wheels") ? "wheels, desired pose" : kind(name);
    });
  }

  /** The names of the limits that are met at a time. */
  met(run, time) {
    const group = run.samples.groups.limits;
    const { row } = run.samples.locate(time);
    return this.names.filter((name, k) => group.get(row, k) >= AT_BOUND);
  }

  show(run, time) {
    const met = this.met(run, time);
    this.track.values.textContent = met.length
      ? `at the bound: ${met.join(", ")}`
      : "none at its bound (dark)";
  }
}
