// Colours that mean something. Blue is good and red is bad: colour-blind people can tell them apart, and
// the number stands beside the colour wherever it counts.

/** From good to bad. */
const RAMP = ["#4a9fd4", "#a8d3e0", "#f4e3a1", "#f0ad4e", "#dd6b2c", "#a62b3a"];

/** The highest sub-score of each part of the body. */
const WORST_PART = [3, 5, 4, 6, 2, 3];

/** Red, green and blue from 0 to 1. */
function rgb(hex) {
  const value = parseInt(hex.slice(1), 16);
  return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}

const RAMP_RGB = RAMP.map(rgb);

/** The colour of a share from 0, good, to 1, bad. */
function ramp(share) {
  const place = Math.min(Math.max(share, 0), 1) * (RAMP.length - 1);
  const index = Math.min(Math.floor(place), RAMP.length - 2);
  const part = place - index;
  return RAMP_RGB[index].map((low, k) => low + (RAMP_RGB[index + 1][k] - low) * part);
}

/** Of a part's sub-score: 1 is best, and the worst that the part can have is 1 on the ramp. */
function partColour(part, score) {
  return ramp((score - 1) / (WORST_PART[part] - 1));
}

function css([red, green, blue], alpha = 1) {
  const byte = (value) => Math.round(255 * value);
  return `rgb(${byte(red)} ${byte(green)} ${byte(blue)} / ${alpha})`;
}

/** Black or white, whichever can be read on a colour. */
function inkOn([red, green, blue]) {
  return 0.299 * red + 0.587 * green + 0.114 * blue > 0.52 ? "#101418" : "#ffffff";
}

/** The value of a colour of the style sheet in the theme of now. */
function themeColour(name) {
  const probe = document.createElement("i");
  probe.style.color = `var(${name})`;
  document.body.append(probe);
  const found = getComputedStyle(probe)
    .color.match(/[\d.]+/g)
    .slice(0, 3);
  probe.remove();
  return found.map((value) => Number(value) / 255);
}

/** Returns true if the page is dark now. */
function isDark() {
  return themeColour("--sky")[0] < 0.5;
}

/** The score that has the last colour of the ramp. */
const SCORE_MOST = 2.5;

function scoreColour(score) {
  return ramp(score / SCORE_MOST);
}

/** REBA from 1 to 15; action is asked for soon from 8 on. */
function rebaColour(reba) {
  return ramp((reba - 1) / 9);
}

/** What the scene is drawn in. */
function readTheme() {
  const dark = isDark();
  const colour = (name) => themeColour(`--${name}`);
  return {
    sky: colour("sky"),
    ground: colour("ground"),
    grid: colour("floor-line"),
    edge: colour("edge"),
    workspace: colour("workspace"),
    desired: colour("desired"),
    trail: colour("trail"),
    distance: colour("distance"),
    axisX: rgb("#d2453a"),
    axisY: rgb("#2a9d5c"),
    axisZ: rgb("#3671d9"),
    shadow: dark ? [0, 0, 0] : [0.1, 0.14, 0.2],
    shade: dark ? 0.38 : 0.16,
  };
}
