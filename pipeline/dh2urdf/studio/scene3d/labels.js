// Texts beside their points.
import { THREE } from "nicegui-scene";

const ROWS = [-1, 0, -2, 1, -3, 2, -4, 3]; // of a label above and below its point, in its own heights

export const labels = {
  label(text, layer, kind) {
    const element = document.createElement("div");
    element.textContent = text;
    element.className = `arm-view-label ${kind}`;
    this.sheet.append(element);
    const label = new THREE.Object3D();
    label.userData = { layer, element };
    label.visible = layer === null || this.layers.has(layer);
    return label;
  },

  // Labels beside their points and none over another: what stands out comes first, what finds no room is left out.
  place() {
    const labels = [];
    this.scene.traverse((object) => object.userData.element && labels.push(object));
    const is = (label, kind) => label.userData.element.classList.contains(`arm-view-${kind}`);
    const rank = (label) => is(label, "stroke") - is(label, "picked");
    labels.sort((one, other) => rank(one) - rank(other));
    for (const { userData: own } of labels) own.size ??= [own.element.offsetWidth, own.element.offsetHeight]; // all at once
    const { clientWidth, clientHeight } = this.$el, [w, h] = this.cube.size;
    const taken = [{ x: clientWidth - w, y: 0, w, h }];
    for (const label of labels) {
      const place = label.visible && label.parent.visible && this.room(label, clientWidth, clientHeight, taken);
      if (place) taken.push(place);
      const { style } = label.userData.element;
      style.visibility = place ? "visible" : "hidden";
      if (place) style.transform = `translate(${place.x}px, ${place.y}px)`;
    }
  },

  // A rectangle for a label where no other one is; the place that it had before goes first, so that it does not jump.
  room(label, width, height, taken) {
    const at = new THREE.Vector3().setFromMatrixPosition(label.matrixWorld).project(this.camera);
    const [x, y] = [((at.x + 1) / 2) * width, ((1 - at.y) / 2) * height];
    if (Math.abs(at.z) > 1 || x < 0 || x > width || y < 0 || y > height) return null;
    const own = label.userData;
    const [w, h] = own.size;
    const places = ROWS.flatMap((row) => [x + 7, x - w - 7].map((left) => ({ x: left, y: y + row * (h + 1) + 2, w, h })));
    const free = (one) =>
      one.x >= 0 && one.y >= 0 && one.x + w <= width && one.y + h <= height &&
      taken.every((other) => one.x + w < other.x || other.x + other.w < one.x || one.y + h < other.y || other.y + other.h < one.y);
    const index = [own.index ?? 0, ...places.keys()].find((index) => free(places[index]));
    own.index = index;
    return index === undefined ? null : places[index];
  },
};
