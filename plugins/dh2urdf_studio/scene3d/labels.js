// Texts beside their points.
import { THREE } from "nicegui-scene";

const ROWS = [-1, 0, -2, 1, -3, 2, -4, 3]; // of a label above and below its point, in its own heights
const ONE = 1e-4; // frames nearer than that are at one point, in reaches of the arm
const LEAST = 9; // length of the line from a label to its point; what is shorter is not drawn [px]

// The names of frames at one point, as one text: {0} {1} flange, and {3}–{7} for many.
function together(texts) {
  const number = (text) => Number(/^\{(\d+)\}$/.exec(text)?.[1] ?? NaN);
  const rank = (text) => (isNaN(number(text)) ? Infinity : number(text));
  const runs = [];
  for (const text of [...new Set(texts)].sort((one, other) => rank(one) - rank(other) || 0)) {
    const run = runs.at(-1);
    if (run && number(run.at(-1)) + 1 === number(text)) run.push(text);
    else runs.push([text]);
  }
  return runs.map((run) => (run.length > 2 ? `${run[0]}–${run.at(-1)}` : run.join(" "))).join(" ");
}

export const labels = {
  label(text, layer, kind) {
    const element = document.createElement("div");
    element.textContent = text;
    element.className = `arm-view-label ${kind}`;
    this.sheet.append(element);
    const label = new THREE.Object3D();
    label.userData = { layer, element, text };
    label.visible = layer === null || this.layers.has(layer);
    return label;
  },

  // Labels beside their points and none over another: what stands out comes first, what finds no room is left out. A
  // thin line leads from a label that is pushed away to its point.
  place() {
    const labels = [];
    this.scene.traverse((object) => object.userData.element && labels.push(object));
    const is = (label, kind) => label.userData.element.classList.contains(`arm-view-${kind}`);
    const rank = (label) => is(label, "stroke") - is(label, "picked");
    labels.sort((one, other) => rank(one) - rank(other));
    const shown = this.joined(labels.filter((label) => label.visible && label.parent.visible && !this.aside(label.parent)));
    for (const { userData: own } of shown) own.size ??= [own.element.offsetWidth, own.element.offsetHeight]; // all at once
    const { clientWidth, clientHeight } = this.$el;
    const taken = [...this.corners()];
    const lines = [];
    const heads = new Set(shown), eye = this.eye();
    for (const label of labels) {
      const place = heads.has(label) && this.room(label, clientWidth, clientHeight, taken, eye);
      const { style } = label.userData.element;
      style.visibility = place ? "visible" : "hidden";
      if (!place) continue;
      taken.push(place);
      style.transform = `translate(${place.x}px, ${place.y}px)`;
      const { x, y } = place.point;
      const [left, top] = [Math.min(Math.max(x, place.x), place.x + place.w), Math.min(Math.max(y, place.y), place.y + place.h)];
      if (Math.hypot(left - x, top - y) > LEAST) lines.push(`M${x.toFixed(1)} ${y.toFixed(1)}L${left.toFixed(1)} ${top.toFixed(1)}`);
    }
    this.leaders = lines.join("");
    this.$el.querySelector(".arm-view-leaders path").setAttribute("d", this.leaders);
  },

  // Where the cube, the cross and the buttons in the corners are; they are measured once for each size of the page.
  corners() {
    const { left, top } = this.$el.getBoundingClientRect();
    const things = () => [...this.$el.querySelectorAll(".view-cube, .arm-view-cross, .arm-view-projection, .arm-view-quick")];
    this.measured ??= things().map((thing) => thing.getBoundingClientRect()).map(({ x, y, width, height }) => ({ x: x - left, y: y - top, w: width, h: height }));
    return this.measured;
  },

  // Whether a node is none of the two frames of the row that is explained: their neighbours would bury them.
  aside({ name, userData: { row, figure } }) {
    if (!this.layers.has("lesson") || this.row === null || row === this.row) return false;
    return this.row ? row !== this.row - 1 : name !== `${figure}frame 0`;
  },

  // Frames at one point share a label; a picked one has its own, which stands out.
  joined(labels) {
    const places = [];
    for (const label of labels) {
      const { layer, element, text } = label.userData;
      if (layer !== "frames" || element.classList.contains("arm-view-picked")) {
        places.push({ label, at: null, texts: [text] });
        continue;
      }
      const at = new THREE.Vector3().setFromMatrixPosition(label.matrixWorld);
      const place = places.find((other) => other.at && other.at.distanceTo(at) < ONE * this.reach);
      if (place) place.texts.push(text);
      else places.push({ label, at, texts: [text] });
    }
    return places.map(({ label, texts }) => {
      const { element } = label.userData, text = together(texts);
      if (element.textContent !== text) {
        element.textContent = text;
        delete label.userData.size;
      }
      return label;
    });
  },

  // A rectangle for a label where no other one is; the place that it had before goes first, so that it does not jump.
  room(label, width, height, taken, eye) {
    const at = new THREE.Vector3().setFromMatrixPosition(label.matrixWorld).project(eye);
    const [x, y] = [((at.x + 1) / 2) * width, ((1 - at.y) / 2) * height];
    if (Math.abs(at.z) > 1 || x < 0 || x > width || y < 0 || y > height) return null;
    const own = label.userData;
    const [w, h] = own.size, point = { x, y };
    const places = ROWS.flatMap((row) => [x + 7, x - w - 7].map((left) => ({ x: left, y: y + row * (h + 1) + 2, w, h, point })));
    const free = (one) =>
      one.x >= 0 && one.y >= 0 && one.x + w <= width && one.y + h <= height &&
      taken.every((other) => one.x + w < other.x || other.x + other.w < one.x || one.y + h < other.y || other.y + other.h < one.y);
    const index = [own.index ?? 0, ...places.keys()].find((index) => free(places[index]));
    own.index = index;
    return index === undefined ? null : places[index];
  },
};
