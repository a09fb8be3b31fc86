// Time: it plays, stops and goes where it is sent.

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];

class Player {
  constructor(begin, end, changed) {
    Object.assign(this, { begin, end, changed, time: begin, playing: false, speed: 1 });
    this.frames = { count: 0, since: 0 };
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.begin), this.end);
    this.changed();
  }

  step(by) {
    this.seek(this.time + by);
  }

  toggle(playing = !this.playing) {
    if (playing === this.playing) return;
    this.playing = playing;
    if (playing) {
      if (this.time >= this.end) this.time = this.begin;
      this.last = null;
      this.frames = { count: 0, since: performance.now() };
      requestAnimationFrame((now) => this.advance(now));
    }
    this.changed();
  }

  advance(now) {
    if (!this.playing) return;
    const elapsed = this.last === null ? 0 : Math.min((now - this.last) / 1000, 0.25);
    this.last = now;
    this.time += elapsed * this.speed;
    if (this.time >= this.end) {
      this.time = this.end;
      this.playing = false;
    }
    this.frames.count += 1;
    this.changed();
    if (this.playing) requestAnimationFrame((next) => this.advance(next));
  }

  /** Pictures a second since it plays. */
  rate() {
    return (1000 * this.frames.count) / (performance.now() - this.frames.since);
  }

  faster(by) {
    const index = SPEEDS.indexOf(this.speed) + by;
    this.speed = SPEEDS[Math.min(Math.max(index, 0), SPEEDS.length - 1)];
    this.changed();
  }
}

/** Lets keys move time and view. `actions` maps a key to what it does. */
function listenToKeys(actions) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (document.querySelector("dialog[open]")) return;
    const inControl = event.target.closest?.("select, input, summary, a");
    const onButton = event.target.closest?.("button");
    if (inControl && event.key !== "Escape") return;
    if (onButton && (event.key === " " || event.key === "Enter")) return;
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action(event);
  });
}
