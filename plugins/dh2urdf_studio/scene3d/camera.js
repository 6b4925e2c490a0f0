// Where the camera stands, and what it has to see.
import { THREE } from "nicegui-scene";
import { AXES } from "dh2urdf-scene/shapes.js";

const STEP = Math.PI / 36; // of an arrow key [rad]
const SOFTNESS = 120; // after this time the camera has gone two thirds of its way [ms]
const MARGIN = 34; // of the picture, for labels [px]
const FARTHEST = 1.5; // of the nearest camera that sees all: how far it goes back for the things in the corners
const FROM = new THREE.Vector3(0.62, -0.62, 0.5).normalize(); // where the camera stands first, seen from the arm
const VIEWS = { front: [1, 0, 0], back: [-1, 0, 0], right: [0, -1, 0], left: [0, 1, 0], top: [0, 0, 1], bottom: [0, 0, -1], corner: FROM.toArray() }; // from where they look
const KEYS = { 1: "front", 3: "right", 7: "top", 9: "corner" }; // where modellers have them on the number pad

export const camera = {
  // Whether the picture holds all of the arm, and is not much larger.
  seen() {
    const points = this.points();
    const inside = this.within(points);
    const span = (axis) => Math.max(...points.map((p) => p[axis])) - Math.min(...points.map((p) => p[axis]));
    return inside && Math.max(span("x"), span("y")) > 0.5;
  },

  // Whether points are in the picture; afterwards they are where they are in it.
  within(points) {
    this.camera.updateMatrixWorld();
    const eye = this.eye();
    return points.every((point) => point.project(eye).toArray().every((part) => Math.abs(part) <= 1));
  },

  // The camera where it sees all of the arm, and is no farther away than that needs; from where it looks now, if it is
  // to keep its direction.
  fit(keep = false) {
    const { position, target } = this.framing(keep ? this.away() : FROM);
    this.goal = null;
    this.controls.target.copy(target);
    this.camera.position.copy(position);
    this.range();
    this.own = false;
    this.fitted = this.reach;
    this.grid(this.reach);
    this.draw();
  },

  // The direction to the camera from what it looks at.
  away() {
    const seen = this.camera.position.clone().sub(this.controls.target).normalize();
    return seen.lengthSq() ? seen : FROM;
  },

  // What is nearer or farther than all of the arm is not drawn.
  range() {
    this.camera.near = 0.005 * this.reach;
    this.camera.far = 20 * (this.camera.position.distanceTo(this.controls.target) + this.reach);
    this.camera.updateProjectionMatrix();
    this.controls.update();
  },

  // Where the camera sees all points from a direction, and is no farther away than that needs, and what it looks at then.
  framing(away, points = this.points()) {
    const right = new THREE.Vector3().crossVectors(this.camera.up, away).normalize();
    const up = new THREE.Vector3().crossVectors(away, right);
    // A camera at c sees p where |(p - c)·right| <= t (c - p)·away, and so for up: for each of the two directions two
    // planes, which the outermost points push away. The nearest c that satisfies all of them is to be had at once.
    // Parallel rays see p, however far it is, where |(p - c)·right| <= t (c - target)·away.
    const depth = points.reduce((sum, p) => sum + p.dot(away), 0) / points.length;
    const near = this.parallel ? () => depth : (p) => p.dot(away);
    let distance = depth + 0.3 * this.reach; // of a robot that is a point
    const sides = this.margins(right, up).map(([direction, slope]) => {
      const [one, other] = [1, -1].map((sign) => Math.max(...points.map((p) => sign * p.dot(direction) + slope * near(p))));
      distance = Math.max(distance, (one + other) / (2 * slope));
      return direction.clone().multiplyScalar((one - other) / 2);
    });
    const beside = sides[0].add(sides[1]);
    const found = { target: beside.clone().addScaledVector(away, depth), position: beside.addScaledVector(away, distance) };
    return this.uncovered(found, right, up, points) ?? found;
  },

  // The same from farther away, where no point is below a thing in a corner of the picture; null if that would
  // be too far.
  uncovered({ target, position }, right, up, points) {
    const { clientWidth: width, clientHeight: height } = this.$el;
    const tall = Math.tan((this.camera.fov * Math.PI) / 360), wide = tall * this.camera.aspect, corners = this.corners();
    const away = position.clone().sub(target), seen = new THREE.Vector3();
    for (let farther = 1; farther <= FARTHEST; farther += 0.04) {
      const from = target.clone().addScaledVector(away, farther), distance = from.distanceTo(target);
      const covered = points.some((p) => {
        const depth = this.parallel ? distance : -seen.copy(p).sub(from).dot(away) / away.length();
        seen.copy(p).sub(from);
        const [x, y] = [((1 + seen.dot(right) / (depth * wide)) / 2) * width, ((1 - seen.dot(up) / (depth * tall)) / 2) * height];
        return corners.some((one) => x > one.x && x < one.x + one.w && y > one.y && y < one.y + one.h);
      });
      if (!covered) return { target, position: from };
    }
    return null;
  },

  // Where the joints have moved the arm out of the picture, the camera goes after it: aside and back, never nearer. It
  // does not while a person holds it, looks at a part of the arm, or drags a link or the handle.
  follow() {
    if (this.followsPicked && this.pickedAt) return;
    if (this.holding || this.plane || this.held || this.turning || !this.fitted) return;
    const lost = this.handle.visible && !this.within([this.handle.position.clone()]);
    if (this.own && !lost) return;
    const points = this.points();
    if (!this.goal && this.within(points.map((point) => point.clone()))) return;
    const away = this.away(), goal = this.framing(away, points);
    const now = this.camera.position.distanceTo(this.controls.target);
    if (goal.position.distanceTo(goal.target) < now) goal.position.copy(goal.target).addScaledVector(away, now);
    this.goal = goal;
    this.own = false;
  },

  // Where the picked link is, or the frame of the picked row; null if none is picked.
  picked() {
    const node = this.nodes.find((node) => this.isPicked(node));
    return node ? new THREE.Vector3().setFromMatrixPosition(node.matrix) : null;
  },

  // The camera moves with what is picked, from now on or no longer.
  followPicked(on) {
    this.followsPicked = on;
    this.pickedAt = this.picked();
  },

  // What is picked has moved: if the camera follows it, it stays where it was in the picture.
  keepPicked() {
    const place = this.picked();
    if (this.followsPicked && place && this.pickedAt) {
      const by = place.clone().sub(this.pickedAt);
      for (const moved of [this.controls.target, this.camera.position, this.goal?.target, this.goal?.position]) moved?.add(by);
      this.range();
    }
    this.pickedAt = place;
  },

  // The camera is at its goal at once: pictures are not taken on the way.
  arrive() {
    if (!this.goal) return;
    this.camera.position.copy(this.goal.position);
    this.controls.target.copy(this.goal.target);
    this.goal = this.stepped = null;
    this.range();
  },

  // A step of the camera towards its goal.
  glide() {
    const now = performance.now(), passed = Math.min(now - (this.stepped || now), 100);
    this.stepped = this.goal ? now : undefined;
    if (!this.goal) return;
    const { position, target } = this.goal, still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const near = this.camera.position.distanceTo(position) + this.controls.target.distanceTo(target) < 0.002 * this.reach;
    const share = still || near ? 1 : 1 - Math.exp(-passed / SOFTNESS);
    this.camera.position.lerp(position, share);
    this.controls.target.lerp(target, share);
    if (share === 1) return this.arrive();
    this.range();
    this.draw();
  },

  // The camera where it sees all of the arm from one of the standard sides.
  look(view) {
    this.lookFrom(VIEWS[view]);
  },

  // The same from any direction; from above, the front is below in the picture.
  lookFrom([x, y, z]) {
    this.camera.position.copy(this.controls.target).add(new THREE.Vector3(x || y ? x : 1e-4, y, z));
    this.fit(true);
  },

  // What has to be seen: the corners of links and joint axes, the tips of frames, and the origins of all nodes.
  points() {
    this.scene.updateMatrixWorld();
    const points = this.nodes.map((node) => new THREE.Vector3().setFromMatrixPosition(node.matrixWorld));
    const corners = ({ min, max }) => [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => new THREE.Vector3(x, y, z))));
    for (const { geometry } of this.cloud.children) points.push(...corners(geometry.boundingBox));
    this.arm.traverse((object) => {
      if (object.isMesh && object.visible && object.userData.layer === "frames")
        for (const [, tip] of AXES) points.push(tip.clone().multiplyScalar(1.1).applyMatrix4(object.matrixWorld));
      if (!object.isMesh || !["links", "axes"].includes(object.userData.layer)) return;
      points.push(...corners(object.geometry.boundingBox).map((corner) => corner.applyMatrix4(object.matrixWorld)));
    });
    return points.length ? points : [[-0.8, -0.8, 0], [0.8, -0.8, 0], [0.8, 0.8, 0], [0, 0, 0.9]].map((p) => new THREE.Vector3(...p));
  },

  // Directions of the picture, each with the slope of the rays at its margin.
  margins(right, up) {
    const { clientWidth: width, clientHeight: height } = this.$el;
    const tall = Math.tan((this.camera.fov * Math.PI) / 360), wide = tall * this.camera.aspect;
    return [[right, wide * (1 - (2 * MARGIN) / (width || 1e3))], [up, tall * (1 - (2 * MARGIN) / (height || 1e3))]];
  },

  // The middle of the arm, and the distance from which the camera sees all of it on a turn about that.
  round() {
    const points = this.points(), middle = new THREE.Box3().setFromPoints(points).getCenter(new THREE.Vector3());
    for (const point of points) point.sub(middle);
    const away = this.camera.position.clone().sub(this.controls.target).normalize(), z = this.camera.up;
    let distance = 0.3 * this.reach;
    for (let step = 0; step < 36; step++) {
      away.applyAxisAngle(z, Math.PI / 18);
      const right = new THREE.Vector3().crossVectors(z, away).normalize(), up = new THREE.Vector3().crossVectors(away, right);
      for (const [direction, slope] of this.margins(right, up))
        for (const point of points) distance = Math.max(distance, Math.abs(point.dot(direction)) / slope + (this.parallel ? 0 : point.dot(away)));
    }
    return { middle, distance };
  },

  // A frame of a turn of the camera about the arm, as a data address: from where it looks now, a share of the turn on,
  // with a longer side of at most so many pixels. After the last one null ends the turn, and the camera is back.
  turn(share, largest) {
    this.arrive();
    const { camera, controls } = this, z = new THREE.Vector3(0, 0, 1);
    if (share === null) {
      if (this.turning) camera.position.copy(this.turning.position), controls.target.copy(this.turning.target), controls.update();
      this.turning = null;
      return this.draw();
    }
    if (!this.turning) {
      const [position, target] = [camera.position.clone(), controls.target.clone()];
      this.turning = { position, target, ...(this.own ? { middle: target, distance: position.distanceTo(target) } : this.round()) };
      this.turning.fine = Math.min(1, largest / Math.max(this.$el.clientWidth, this.$el.clientHeight));
    }
    const { position, target, middle, distance, fine } = this.turning;
    const away = position.clone().sub(target).setLength(distance).applyAxisAngle(z, 2 * Math.PI * share);
    controls.target.copy(middle);
    camera.position.copy(middle).add(away);
    controls.update();
    this.scene.updateMatrixWorld();
    camera.updateMatrixWorld();
    this.place();
    return this.pictured(fine, false).toDataURL("image/png");
  },

  // The camera by keyboard: arrows turn it about what it looks at, + and - move it, 0 sees all, 5 changes how it draws.
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const nearer = { "+": 0.85, "=": 0.85, "-": 1 / 0.85 }[event.key];
    if (!turns && !nearer && !["0", "5"].includes(event.key) && !KEYS[event.key]) return;
    event.preventDefault();
    if (KEYS[event.key]) return this.look(KEYS[event.key]);
    if (event.key === "0") return this.fit(true);
    if (event.key === "5") return this.project(!this.parallel);
    const { target } = this.controls, away = this.camera.position.clone().sub(target);
    const z = new THREE.Vector3(0, 0, 1);
    if (turns) {
      const polar = Math.min(Math.max(away.angleTo(z) + turns[1] * STEP, 0.05), Math.PI - 0.05);
      away.applyAxisAngle(z, turns[0] * STEP);
      const side = new THREE.Vector3().crossVectors(z, away).normalize();
      away.applyAxisAngle(side, polar - away.angleTo(z));
    } else away.multiplyScalar(nearer);
    this.goal = null;
    this.camera.position.copy(target).add(away);
    this.controls.update();
    this.own = !this.seen();
    this.draw();
  },
};
