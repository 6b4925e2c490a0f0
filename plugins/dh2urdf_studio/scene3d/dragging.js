// What is pointed at and dragged: links, which turn or slide with their joints, and the handle at the tool. What a person
// wants is sent one at a time; the newest follows when the one before has been answered.
import { THREE } from "nicegui-scene";

const FACING = 0.3; // cosine of the angle between an axis and the view from which on a turn is seen as one

export const dragging = {
  showHandle(shown) {
    this.handle.visible = shown;
    this.draw();
  },

  // Whether links are dragged by the pointer alone; with Shift they always are.
  grasp(on) {
    this.grasps = on;
    this.$el.querySelector("canvas").style.cursor = "";
  },

  take(event) {
    if (event.button !== 0) return;
    const caster = this.ray(event), facing = this.camera.getWorldDirection(new THREE.Vector3());
    if (this.handle.visible && caster.intersectObject(this.handle).length) {
      this.plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, this.handle.position);
      this.grip = caster.ray.intersectPlane(this.plane, new THREE.Vector3()).sub(this.handle.position);
    } else if (!(this.grasps || event.shiftKey) || !(this.held = this.grasped(caster, facing))) return;
    this.goal = null;
    this.begins = true;
    this.controls.enabled = false;
    event.currentTarget.setPointerCapture(event.pointerId);
    if (this.held) event.currentTarget.style.cursor = "grabbing";
  },

  // A link that is pointed at and the joint that moves it; null beside all links, and for one that no joint moves.
  grasped(caster, facing) {
    const { node, point } = this.hit(caster);
    const grip = node?.userData.grip;
    if (!grip) return null;
    const carrier = this.nodes.find(({ name }) => name === grip.carrier);
    const axis = new THREE.Vector3(...grip.axis).transformDirection(carrier.matrixWorld);
    const origin = new THREE.Vector3().setFromMatrixPosition(carrier.matrixWorld);
    const arm = point.clone().sub(origin).projectOnPlane(axis); // from the axis to where the link is held
    const flat = !grip.slides && Math.abs(axis.dot(facing)) > FACING;
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(flat ? axis : facing, point);
    return { node: node.name, slides: grip.slides, axis, origin, arm, flat, plane, last: point, by: 0 };
  },

  drag(event) {
    if (this.held) return this.pull(this.ray(event).ray);
    if (!this.plane) return this.hover(event);
    const place = this.ray(event).ray.intersectPlane(this.plane, new THREE.Vector3());
    if (place) this.want("aim", { place: place.sub(this.grip).toArray() });
  },

  // How far the joint has to turn [rad] or to slide [m] for the link to stay below the pointer.
  pull(ray) {
    const { held } = this, { axis, origin, last } = held;
    const place = held.slides ? last : ray.intersectPlane(held.plane, new THREE.Vector3());
    if (!place) return;
    if (held.slides) {
      // Where the line along the axis through the point that was taken is nearest to the ray of the pointer.
      const from = last.clone().sub(ray.origin), along = axis.dot(ray.direction), crossing = 1 - along * along;
      if (crossing < 0.01) return; // it is seen from its end
      held.by = (along * ray.direction.dot(from) - axis.dot(from)) / crossing;
    } else if (held.flat) {
      const [one, other] = [last, place].map((point) => point.clone().sub(origin).projectOnPlane(axis));
      held.by += Math.atan2(one.clone().cross(other).dot(axis), one.dot(other));
    } else if (held.arm.lengthSq() > 1e-12) {
      held.by += place.clone().sub(last).dot(axis.clone().cross(held.arm)) / held.arm.lengthSq();
    }
    held.last = place;
    this.want("grip", { node: held.node, by: held.by });
  },

  // The pointer is a hand above a link that it would move.
  hover(event) {
    if (!this.grasps || event.buttons || this.hovers) return;
    this.hovers = true;
    const canvas = event.currentTarget, caster = this.ray(event);
    requestAnimationFrame(() => {
      this.hovers = false;
      canvas.style.cursor = this.hit(caster).node?.userData.grip ? "grab" : "";
    });
  },

  want(kind, what) {
    this.wanted = [kind, what];
    this.ask();
  },

  ask() {
    if (this.asked || !this.wanted) return;
    this.asked = true;
    const [kind, what] = this.wanted;
    this.$emit(kind, { ...what, begins: this.begins });
    this.wanted = null;
    this.begins = false;
  },

  answered() {
    this.asked = false;
    this.ask();
  },

  release() {
    if (!this.plane && !this.held) return;
    this.plane = this.held = null;
    this.controls.enabled = true;
    this.$el.querySelector("canvas").style.cursor = "";
    this.follow();
    this.draw();
  },

  // The ray from the camera through the pointer.
  ray(event) {
    const canvas = event.currentTarget.getBoundingClientRect();
    const caster = new THREE.Raycaster();
    const x = (2 * (event.clientX - canvas.left)) / canvas.width - 1;
    const y = 1 - (2 * (event.clientY - canvas.top)) / canvas.height;
    caster.setFromCamera(new THREE.Vector2(x, y), this.eye());
    return caster;
  },

  // The node that a ray meets first, and where.
  hit(caster) {
    const shown = this.nodes.filter((node) => node.visible);
    const hit = caster.intersectObjects(shown, true).find(({ object }) => object.visible && object.isMesh);
    let node = hit?.object;
    while (node && node.userData.row === undefined) node = node.parent;
    return { node, point: hit?.point };
  },

  pick(event) {
    const { node } = this.hit(this.ray(event));
    this.$emit("pick", { row: node?.userData.row ?? null, node: node?.name ?? null });
  },
};
