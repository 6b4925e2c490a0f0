// DH parameters and common normals as segments and arcs with arrow heads.
import { THREE } from "nicegui-scene";
import { UP } from "dh2urdf-scene/shapes.js";

const STROKES = { a: 0xd6336c, alpha: 0xe8590c, d: 0x1c7ed6, theta: 0x2f9e44, x: 0xe03131, y: 0x2f9e44, z: 0x1971c2, distance: 0x495057, line: 0x868e96, normal: 0xc2255c, offset: 0x1971c2, foot: 0x212529 };

export const strokes = {
  stroke({ row, field, points, label }) {
    const vectors = points.map((point) => new THREE.Vector3(...point));
    if (vectors.length === 1) return this.foot(row, field, vectors[0]);
    const path = new THREE.CurvePath();
    for (let i = 1; i < vectors.length; i++) path.add(new THREE.LineCurve3(vectors[i - 1], vectors[i]));
    const radius = (field === "line" ? 0.002 : 0.006) * this.lines * this.reach;
    const material = new THREE.MeshBasicMaterial({ color: STROKES[field], depthTest: false, transparent: true });
    const tube = new THREE.Mesh(new THREE.TubeGeometry(path, Math.max(1, 2 * (vectors.length - 1)), radius, 6), material);
    const head = new THREE.Mesh(new THREE.ConeGeometry(2.2 * radius, 6 * radius, 12).translate(0, -2 * radius, 0), material);
    const [last, end] = vectors.slice(-2); // it points where the parameter leads: an angle has a sign
    head.quaternion.setFromUnitVectors(UP, end.clone().sub(last).normalize());
    head.position.copy(end);
    head.visible = field !== "line";
    tube.renderOrder = head.renderOrder = 2;
    tube.userData.row = row;
    tube.name = row === null ? field : `${field} ${row + 1}`;
    const text = label ? this.label(label, null, `arm-view-stroke arm-view-${field}`) : new THREE.Object3D();
    text.position.copy(vectors.length > 2 ? vectors[Math.floor(vectors.length / 2)] : vectors[0].clone().lerp(vectors[1], 0.5));
    tube.add(text, head);
    this.emphasise(tube);
    return tube;
  },

  foot(row, field, point) {
    const material = new THREE.MeshBasicMaterial({ color: STROKES[field], depthTest: false, transparent: true });
    const ball = new THREE.Mesh(this.geometries.sphere, material);
    ball.position.copy(point);
    ball.scale.setScalar(0.012 * this.reach);
    ball.renderOrder = 2;
    ball.name = `${field} ${row + 1}`;
    ball.userData = { row, shared: true };
    ball.add(new THREE.Object3D());
    this.emphasise(ball);
    return ball;
  },

  // Where a row is picked, only its own parameters are shown.
  emphasise(tube) {
    const on = [null, this.row].includes(tube.userData.row) || this.row === null;
    tube.material.opacity = on ? 1 : 0.3;
    tube.children[0].visible = on;
  },
};
