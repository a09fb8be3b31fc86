// States on the time line. Each has its name in it, or where it is too short, in its tip; states of
// caution and stop are hatched as well as coloured.

/** Patterns that tones have beside their colours. */
function addPatterns(parent) {
  const definitions = svg(
    "svg",
    { width: 0, height: 0, class: "definitions", "aria-hidden": "true" },
    parent,
  );
  for (const [name, size, path] of [
    ["caution", 8, "M-2 10 L10 -2 M-2 2 L2 -2 M6 10 L10 6"],
    ["stop", 6, "M-1 -1 L7 7 M-1 7 L7 -1"],
  ]) {
    const pattern = svg(
      "pattern",
      { id: `hatch-${name}`, width: size, height: size, patternUnits: "userSpaceOnUse" },
      definitions,
    );
    svg("path", { d: path, class: "hatch" }, pattern);
  }
}

class Lanes {
  constructor(parent, page, seek) {
    this.page = page;
    this.seek = seek;
    this.tracks = new Map();
    addPatterns(parent);
    for (const lane of page.runs[0].lanes) {
      this.tracks.set(lane.name, new Track(parent, lane.name, "", 34));
    }
  }

  draw(axis, run) {
    for (const lane of run.lanes) {
      const track = this.tracks.get(lane.name);
      if (!track) continue;
      track.clear(axis);
      for (const span of this.merged(lane.spans, axis)) this.drawSpan(track, axis, span);
    }
  }

  /** Spans that can be told apart at this width: of several within a pixel the gravest. */
  merged(spans, axis) {
    const grave = ["quiet", "work", "walk", "caution", "stop"];
    const found = [];
    for (const span of spans) {
      const last = found.at(-1);
      if (last && axis.x(span.end) - axis.x(last.begin) < 1.5) {
        if (grave.indexOf(span.tone) > grave.indexOf(last.tone))
          Object.assign(last, { tone: span.tone, label: span.label });
        last.end = span.end;
      } else {
        found.push({ ...span });
      }
    }
    return found;
  }

  drawSpan(track, axis, span) {
    const x = axis.x(span.begin);
    const width = Math.max(axis.x(span.end) - x, 1.5);
    const group = svg("g", { class: `span ${span.tone}` }, track.picture);
    svg("rect", { x, y: 7, width, height: track.height - 14, rx: Math.min(3, width / 2) }, group);
    if (span.tone === "caution" || span.tone === "stop") {
      svg(
        "rect",
        { x, y: 7, width, height: track.height - 14, fill: `url(#hatch-${span.tone})`, class: "over" },
        group,
      );
    }
    if (width > 7 * span.label.length * 0.86 + 8) {
      svg("text", { x: x + 5, y: track.height / 2 + 3.8 }, group).textContent = span.label;
    }
    const seconds = `${written(span.begin, 2)} s to ${written(span.end, 2)} s`;
    svg("title", {}, group).textContent = `${span.label}: ${seconds}`;
  }

  /** The state of each lane at a time, in its heading. */
  show(run, time) {
    for (const lane of run.lanes) {
      const track = this.tracks.get(lane.name);
      if (track) track.values.textContent = stateAt(lane, time)?.label ?? "–";
    }
  }
}

function stateAt(lane, time) {
  return lane.spans.findLast((span) => span.begin <= time) ?? null;
}

/** The times at which any lane changes, in order. */
function transitions(run) {
  const times = run.lanes
    .filter((lane) => lane.name !== "action seen")
    .flatMap((lane) => lane.spans.map((span) => span.begin));
  return [...new Set(times)].sort((a, b) => a - b);
}
