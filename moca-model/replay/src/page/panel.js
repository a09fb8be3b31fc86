// What is said in words and numbers: the posture, the results, the state of things at the cursor.

const PART_NAMES = ["neck", "trunk", "legs", "upper arm", "lower arm", "wrist"];

/** Sub-scores of the posture that was seen and of the one with the hand at the tool. */
class PosturePanel {
  constructor(parent, page) {
    const table = html("table", { class: "posture" }, parent);
    const head = html("tr", {}, html("thead", {}, table));
    html("th", { scope: "col", text: "REBA" }, head);
    html("th", { scope: "col", text: "seen" }, head);
    html("th", { scope: "col", text: "hand at the tool" }, head);
    const body = html("tbody", {}, table);
    const row = (name, className) => {
      const line = html("tr", className ? { class: className } : {}, body);
      html("th", { scope: "row", text: name }, line);
      return [0, 1].map(() => html("span", { class: "chip" }, html("td", {}, line)));
    };
    this.rows = PART_NAMES.map((name) => row(name));
    this.total = row("score", "total");
    this.page = page;
  }

  show(run, time) {
    const seen = run.person.locate(time).row;
    const known = time - run.person.times[seen] < 0.5;
    const now = run.samples.locate(time).row;
    const tables = [
      [run.person, seen, known],
      [run.samples, now, true],
    ];
    this.rows.forEach((cells, part) => {
      tables.forEach(([table, row, shown], column) => {
        const score = shown ? table.groups.parts.get(row, part) : NaN;
        chip(cells[column], score, (known) => partColour(part, known), `of ${WORST_PART[part]}`);
      });
    });
    ["REBA measured", "REBA predicted"].forEach((series, column) => {
      const score = run.at(time, series);
      chip(this.total[column], score, rebaColour, "of 15");
    });
  }
}

function chip(element, score, colourOf, of) {
  const known = !Number.isNaN(score);
  const colour = known ? colourOf(score) : null;
  element.textContent = known ? Math.round(score) : "–";
  element.title = known ? `${Math.round(score)} ${of}` : "not known";
  element.style.background = known ? css(colour) : "transparent";
  element.style.color = known ? inkOn(colour) : "inherit";
}

/** The table of results, as the program prints it. */
function addResults(parent, page) {
  const table = html("table", { class: "results", id: "results" }, parent);
  const head = html("tr", {}, html("thead", {}, table));
  html("th", { scope: "col", text: "" }, head);
  page.runs.forEach((run, index) => {
    const cell = html("th", { scope: "col" }, head);
    html("span", { class: `swatch run-${index}` }, cell);
    cell.append(run.title);
  });
  const body = html("tbody", {}, table);
  for (const row of page.results.rows) {
    const line = html("tr", {}, body);
    html(
      "th",
      { scope: "row", text: row.name.trim(), class: row.name.startsWith(" ") ? "within" : "" },
      line,
    );
    page.runs.forEach((run, index) => {
      html("td", { text: written(row.values[index] ?? NaN, row.digits) }, line);
    });
  }
  if (page.results.text) {
    html("h2", { text: "All cases" }, parent);
    html("pre", { id: "cases", tabindex: 0, text: page.results.text }, parent);
  }
}

/** What colours and lines mean. */
function addLegend(parent) {
  const scale = html("div", { class: "scale" }, parent);
  html("span", { text: "good" }, scale);
  const bar = html("span", { class: "bar", "aria-hidden": "true" }, scale);
  bar.style.background = `linear-gradient(90deg, ${RAMP.join(", ")})`;
  html("span", { text: "bad" }, scale);
  html(
    "p",
    {
      text: `The person's parts by their REBA sub-score; the map by e_s, from 0 to ${SCORE_MOST}, with a line each 0.5. The arm that is not scored is grey. The body that was seen is averaged over 0.35 s for the eye.`,
    },
    parent,
  );
  const entries = [
    ["workspace", "shared workspace"],
    ["desired", "desired place of the tool"],
    ["trail", "way of the tool in the last 2.5 s"],
    ["distance", "least distance of robot and person"],
  ];
  const list = html("ul", { class: "legend" }, parent);
  for (const [name, text] of entries) {
    const item = html("li", {}, list);
    html("span", { class: `mark ${name}`, "aria-hidden": "true" }, item);
    item.append(text);
  }
}

/** Keys and what they do; the player listens to the same. */
const KEYS = [
  ["Space", "play or pause"],
  ["← →", "back, on by 1 s; with Shift by 0.1 s"],
  [", .", "back, on by a sample"],
  ["[ ]", "to the transition before, after"],
  ["Home End", "to the beginning, the end"],
  ["1 2", "the first, the second run"],
  ["+ −", "faster, slower"],
  ["W A S D", "turn the view"],
  ["Q E", "nearer, farther"],
  ["V", "next view"],
  ["F", "eye follows, or stands"],
  ["M", "map: level, upright, none"],
  ["B P", "body seen, posture with the hand at the tool"],
  ["O T L", "workspace, tool, distance"],
  ["N", "light, dark"],
  ["?", "this list"],
];

function addHelp(dialog) {
  html("h2", { text: "Keys, mouse and fingers" }, dialog);
  const list = html("dl", {}, dialog);
  for (const [keys, text] of KEYS) {
    const key = html("dt", {}, list);
    for (const one of keys.split(" ")) html("kbd", { text: one }, key);
    html("dd", { text }, list);
  }
  html(
    "p",
    {
      text: "Drag turns the view, drag with Shift or the right button moves it, the wheel comes nearer; one finger turns, two move and zoom. A click or drag on the plots moves the time.",
    },
    dialog,
  );
  const close = html("button", { type: "button", text: "Close" }, dialog);
  close.addEventListener("click", () => dialog.close());
}
