// What is to be drawn at a time: robot, person, workspace, map and distances as shapes.

const GREY_PART = [0.72, 0.74, 0.77];

class Scene {
  constructor(page) {
    this.page = page;
    this.rods = new Instances(12);
    this.boxes = new Instances(14);
    this.cylinders = new Instances(14);
    this.marks = new Instances(12);
    this.glass = new Instances(14);
    this.slice = null;
    this.labels = [];
  }

  /** Makes the shapes of a run at a time; `shown` says of what. */
  build(run, time, shown, theme) {
    for (const list of [this.rods, this.boxes, this.cylinders, this.marks, this.glass]) list.count = 0;
    this.slice = null;
    this.labels = [];
    const at = run.samples.locate(time);
    const pose = (name) => this.pose(run, at, run.samples.groups.frames.index(name));
    this.addSolids(run, at);
    this.addPerson(run, time, at, shown);
    if (shown.workspace) this.addWorkspace(run, at, pose("workspace"), theme);
    if (shown.tool) this.addTool(run, at, time, pose("tool"), pose("desired"), theme);
    if (shown.distance) this.addDistance(run, at, theme);
    if (shown.map) this.slice = this.mapSlice(pose("person"), pose("tool"), shown.map);
  }

  /** Position and rotation of a frame; none where it is nowhere. */
  pose(run, at, place) {
    if (place < 0) return null;
    const frames = run.samples.groups.frames;
    const position = [0, 0, 0];
    if (!pointAt(frames, place, at, position)) return null;
    const turn = (row) => [3, 4, 5, 6].map((k) => frames.get(row, place + k));
    const next = turn(at.next);
    const rotation = between(turn(at.row), Number.isNaN(next[0]) ? turn(at.row) : next, at.share);
    return { position, rotation };
  }

  /** The robot and what it holds, in their colours or all in one. */
  addSolids(run, at, paint) {
    const known = new Map();
    for (const solid of run.solids) {
      const place = 7 * solid.frame;
      if (!known.has(place)) known.set(place, this.pose(run, at, place));
      const frame = known.get(place);
      if (!frame) continue;
      const position = add(frame.position, rotate(frame.rotation, solid.position));
      const rotation = product(frame.rotation, solid.rotation);
      const { shape } = solid;
      const colour = paint ?? [...solid.colour.map((value) => 0.1 + 0.86 * value), 1];
      if (shape.kind === "box") {
        this.boxes.push(...position, ...rotation, ...shape.size, ...colour);
      } else if (shape.kind === "cylinder") {
        const size = [shape.radius, shape.radius, shape.length];
        this.cylinders.push(...position, ...rotation, ...size, ...colour);
      } else {
        const half = rotate(rotation, [0, 0, (shape.length ?? 0) / 2]);
        const [begin, end] = [subtract(position, half), add(position, half)];
        this.rods.push(...begin, shape.radius, ...end, shape.radius, ...colour);
      }
      if (!paint && (solid.role === "object" || solid.role === "tool")) {
        this.labels.push({ place: position, text: solid.name });
      }
    }
  }

  /** The body that was seen, or the one that the score is of: with the hand at the tool. */
  addPerson(run, time, at, shown) {
    const seen = run.person.locate(time);
    const scores = (group, row) => [0, 1, 2, 3, 4, 5].map((part) => group.get(row, part));
    if (shown.person) {
      const side = run.person.groups.side.get(seen.row, 0);
      const recent = time - run.person.times[seen.row] < 0.5;
      if (recent) this.addBody(run.person.groups.body, seen, scores(run.person.groups.parts, seen.row), side);
      if (run.others) this.addOthers(run.others, time);
    }
    if (shown.posture) {
      const side = this.page.side === "left" ? 1 : -1;
      const parts = scores(run.samples.groups.parts, at.row);
      this.addBody(run.samples.groups.body, at, parts, side);
    }
  }

  /** Other people, as the newest frame shows them: their order may change from frame to frame. */
  addOthers(others, time) {
    const { row } = others.locate(time);
    const age = time - others.times[row];
    if (age < 0 || age >= 0.5) return;
    for (const group of Object.values(others.groups)) {
      this.addBody(group, { row, next: row, share: 0 }, [], 0);
    }
  }

  addBody(group, at, scores, side) {
    const { limbs, stature } = this.page;
    const [begin, end] = [
      [0, 0, 0],
      [0, 0, 0],
    ];
    for (const limb of limbs) {
      if (!pointAt(group, 3 * limb.ends[0], at, begin)) continue;
      if (!pointAt(group, 3 * limb.ends[1], at, end)) continue;
      const score = scores[limb.part];
      const scored = Number.isFinite(score) && (limb.side === 0 || limb.side === side);
      const colour = scored ? partColour(limb.part, score) : GREY_PART;
      this.rods.push(...begin, limb.radii[0] * stature, ...end, limb.radii[1] * stature, ...colour, 1);
    }
  }

  addWorkspace(run, at, pose, theme) {
    if (!pose) return;
    const [low, high] = [
      [0, 0, 0],
      [0, 0, 0],
    ];
    pointAt(run.samples.groups.workspace, 0, at, low);
    pointAt(run.samples.groups.workspace, 3, at, high);
    const inWorld = (point) => add(pose.position, rotate(pose.rotation, point));
    const middle = inWorld(scale(add(low, high), 0.5));
    const colour = theme.workspace;
    this.glass.push(...middle, ...pose.rotation, ...subtract(high, low), ...colour, 0.1);
    for (let axis = 0; axis < 3; axis++) {
      for (let corner = 0; corner < 4; corner++) {
        const from = [0, 0, 0];
        const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        from[axis] = low[axis];
        from[u] = corner & 1 ? high[u] : low[u];
        from[v] = corner & 2 ? high[v] : low[v];
        const to = [...from];
        to[axis] = high[axis];
        this.marks.push(...inWorld(from), 0.005, ...inWorld(to), 0.005, ...colour, 1);
      }
    }
  }

  /** The axes of the tool, where it is wanted, and the way that it came. */
  addTool(run, at, time, tool, desired, theme) {
    const frames = run.samples.groups.frames;
    const place = frames.index("tool");
    const trail = 2.5;
    const point = [0, 0, 0];
    let last = null;
    for (let back = 0; back <= trail; back += 0.06) {
      const then = run.samples.locate(time - back);
      if (time - back < run.begin || !pointAt(frames, place, then, point)) break;
      if (last) {
        const radius = 0.007 * (1 - back / trail);
        this.marks.push(...last, radius, ...point, radius, ...theme.trail, 1);
      }
      last = [...point];
    }
    const axes = [theme.axisX, theme.axisY, theme.axisZ];
    if (tool) {
      axes.forEach((colour, axis) => {
        const end = [0, 0, 0];
        end[axis] = 0.14;
        const tip = add(tool.position, rotate(tool.rotation, end));
        this.marks.push(...tool.position, 0.007, ...tip, 0.007, ...colour, 1);
      });
    }
    if (desired) this.marks.push(...desired.position, 0.022, ...desired.position, 0.022, ...theme.desired, 1);
  }

  addDistance(run, at, theme) {
    const near = run.samples.groups.nearest;
    const [robot, person] = [
      [0, 0, 0],
      [0, 0, 0],
    ];
    if (!pointAt(near, 0, at, robot) || !pointAt(near, 3, at, person)) return;
    const distance = near.get(at.row, 6);
    for (const end of [robot, person]) this.marks.push(...end, 0.014, ...end, 0.014, ...theme.distance, 1);
    const way = subtract(person, robot);
    const dashes = Math.max(1, Math.min(40, Math.round(norm(way) / 0.05)));
    for (let dash = 0; dash < dashes; dash++) {
      const from = add(robot, scale(way, dash / dashes));
      const to = add(robot, scale(way, (dash + 0.55) / dashes));
      this.marks.push(...from, 0.006, ...to, 0.006, ...theme.distance, 1);
    }
    const text = `${distance.toFixed(2)} m`;
    this.labels.push({ place: scale(add(robot, person), 0.5), text, distance: true });
  }

  /** A plane through the tool in the person's frame: level, or upright ahead of them. */
  mapSlice(person, tool, kind) {
    if (!person || !tool) return null;
    const { origin, spacing, counts } = this.page.map;
    const inverse = [...scale(person.rotation, -1), person.rotation[3]];
    const hand = rotate(inverse, subtract(tool.position, person.position));
    const size = counts.map((count) => count * spacing);
    const texel = (point) => point.map((value, k) => (value - origin[k] + 0.5 * spacing) / size[k]);
    const edges = counts.map((count) => (count - 1) * spacing);
    const fixed = kind === "level" ? 2 : 1;
    const [u, v] = kind === "level" ? [0, 1] : [0, 2];
    const corner = [...origin];
    corner[fixed] = Math.min(Math.max(hand[fixed], origin[fixed]), origin[fixed] + edges[fixed]);
    const along = (axis) => [0, 1, 2].map((k) => (k === axis ? edges[axis] : 0));
    const first = texel(corner);
    return {
      origin: add(person.position, rotate(person.rotation, corner)),
      first: rotate(person.rotation, along(u)),
      second: rotate(person.rotation, along(v)),
      mapOrigin: first,
      mapFirst: subtract(texel(add(corner, along(u))), first),
      mapSecond: subtract(texel(add(corner, along(v))), first),
    };
  }

  /** Between robot and person, smooth in time: what the eye looks at. */
  target(run, time) {
    const sum = [0, 0, 0];
    let count = 0;
    const point = [0, 0, 0];
    const frames = run.samples.groups.frames;
    for (const shift of [-1.2, -0.8, -0.4, 0, 0.4, 0.8, 1.2]) {
      const at = run.samples.locate(time + shift);
      for (const name of ["tool", "person", "base_link"]) {
        const place = frames.index(name);
        if (place < 0 || !pointAt(frames, place, at, point)) continue;
        sum[0] += point[0];
        sum[1] += point[1];
        count += 1;
      }
    }
    return count ? [sum[0] / count, sum[1] / count, 0.85] : [0, 0, 0.85];
  }
}

/** Writes the labels of a scene over its picture. */
function showLabels(parent, labels, view) {
  labels.forEach((label, index) => {
    const element = parent.children[index] ?? html("span", {}, parent);
    const place = seenAt(view.matrix, label.place);
    element.hidden = !place;
    element.className = label.distance ? "distance" : "";
    if (element.textContent !== label.text) element.textContent = label.text;
    if (place)
      element.style.transform = `translate(${place[0] * parent.clientWidth}px, ${place[1] * parent.clientHeight}px) translate(-50%, -130%)`;
  });
  [...parent.children].slice(labels.length).forEach((element) => (element.hidden = true));
}
