// How the camera draws: in perspective, or with parallel rays (orthographic), as a drawing of the arm from the side is.
// One camera is turned and moved in both. Its distance from what it looks at is the size of the picture: what lies in
// the plane through that point is equally large in both.
import { THREE } from "nicegui-scene";

const BACK = 40; // how far behind the arm parallel rays begin and end, in its reaches and distances: nothing is cut off

export const projection = {
  // The camera that draws and picks, as the one that is moved stands now.
  eye() {
    if (!this.parallel) return this.camera;
    const { camera, level } = this, { target } = this.controls;
    const distance = camera.position.distanceTo(target), back = BACK * (distance + this.reach);
    level.top = distance * Math.tan((camera.fov * Math.PI) / 360);
    level.right = level.top * camera.aspect;
    [level.bottom, level.left, level.near, level.far] = [-level.top, -level.right, 0, 2 * back];
    level.quaternion.copy(camera.quaternion);
    level.position.set(0, 0, back).applyQuaternion(camera.quaternion).add(target);
    level.updateProjectionMatrix();
    level.updateMatrixWorld();
    return level;
  },

  // Parallel rays or perspective. The camera sees all of the arm in the other way too, unless a person looks at a part.
  // The browser keeps the choice.
  project(parallel) {
    this.arrive();
    this.parallel = parallel;
    dhLook.project(parallel);
    if (!this.own) this.fit(true);
    this.draw();
  },
};
