// Scenes for somebody new, each of a minute: what to do next, and whether it was done.

const SCENES = [
  {
    name: "Hand it over, and turn it",
    begin: (controls) => controls.again({ hands_over: true }),
    steps: [
      ["Offer the object: choose “offer”, and wait for the gripper.", ({ picture }) => picture.phase.label.startsWith("handover") || picture.grasps],
      ["Stand still until the gripper has closed.", ({ picture }) => picture.grasps],
      ["Take the polisher, for the other side of the object.", ({ leads }) => leads.worker.activity === "use" && leads.worker.tool === "polisher"],
      ["The robot turns the object: see the phase.", ({ picture }) => picture.phase.label.startsWith("turning")],
      ["Work on the smooth side.", ({ picture }) => picture.phase.label === "working"],
    ],
  },
  {
    name: "Lead it to the next station",
    begin: (controls) => {
      controls.again({ hands_over: false });
      controls.lead("worker", { activity: "use", tool: "drill" });
    },
    steps: [
      ["Work with the drill until robot and person are together.", ({ picture }) => picture.intention.label !== "apart" && picture.grasps],
      ["Drag the person a metre aside: the robot comes along.", ({ picture, start }) => Math.hypot(picture.floor[0] - start.floor[0], picture.floor[1] - start.floor[1]) > 0.9],
      ["Let go: the robot comes to rest for a person who stands.", ({ picture }) => picture.calm < 0.01 && picture.phase.label === "working"],
      ["Squat, and see e_s: the robot brings the work down.", ({ leads }) => leads.worker.squat > 0.1 || leads.worker.lean > 0.3],
    ],
  },
  {
    name: "Come too near",
    begin: (controls) => controls.lead("worker", { activity: "walk" }),
    steps: [
      ["Empty hands, and walk right up to the robot.", ({ picture }) => picture.safety.tone !== "quiet"],
      ["Lean over it: it keeps away from the head.", ({ leads }) => leads.worker.lean > 0.4],
      ["Step back, and stand upright: it goes on.", ({ picture, leads }) => picture.safety.tone === "quiet" && leads.worker.lean < 0.1],
    ],
  },
];

class Guide {
  constructor(parent, controls) {
    this.controls = controls;
    const bar = html("div", { class: "controls" }, parent);
    this.buttons = SCENES.map((scene) => {
      const button = html("button", { type: "button", text: scene.name }, bar);
      button.addEventListener("click", () => this.begin(scene));
      return button;
    });
    this.list = html("ol", { class: "steps" }, parent);
  }

  begin(scene) {
    Object.assign(this, { scene, done: 0, start: null });
    this.list.replaceChildren();
    for (const [text] of scene.steps) html("li", { text }, this.list);
    scene.begin(this.controls);
    // What was done before the scene does not count.
    this.after = performance.now() + 800;
    this.mark();
  }

  look(picture) {
    if (!this.scene || performance.now() < this.after) return;
    const step = this.scene.steps[this.done];
    if (!step) return;
    this.start ??= picture;
    if (!step[1]({ picture, start: this.start, leads: this.controls.leads })) return;
    this.done += 1;
    this.start = picture;
    this.mark();
  }

  mark() {
    [...this.list.children].forEach((item, index) => {
      item.className = index < this.done ? "done" : index === this.done ? "now" : "";
    });
    this.buttons.forEach((button, index) => button.setAttribute("aria-pressed", SCENES[index] === this.scene));
  }
}
