// Thin lines from each frame to the origin of the frame that carries it.
import { THREE } from "nicegui-scene";
import { styled } from "dh2urdf-scene/shapes.js";

const Z = new THREE.Vector3(0, 0, 1); // along which rods lie
const THIN = 0.0022; // radius in reaches of the arm

export const frameLines = {
  // A line for each node that another one carries, in place of those before. They share a material.
  layLines() {
    this.worn.push(...new Set(this.frameLines.children.map(({ material }) => material)));
    this.frameLines.clear();
    const material = new THREE.MeshBasicMaterial({ color: styled("frame-line"), depthTest: false, transparent: true });
    const byName = new Map(this.nodes.map((node) => [node.name, node]));
    for (const node of this.nodes) {
      const carrier = byName.get(node.userData.carrier);
      if (!carrier) continue;
      const line = new THREE.Mesh(this.geometries.rod, material);
      line.name = `line to ${node.name}`;
      line.userData = { node, carrier };
      line.renderOrder = 2;
      this.frameLines.add(line);
    }
  },

  // The lines where their frames are now; those of hidden frames are hidden, and so is one of no length.
  stretch() {
    this.frameLines.visible = this.layers.has("lines");
    if (!this.frameLines.visible) return;
    const [end, start] = [new THREE.Vector3(), new THREE.Vector3()];
    for (const line of this.frameLines.children) {
      const { node, carrier } = line.userData;
      end.setFromMatrixPosition(node.matrix);
      start.setFromMatrixPosition(carrier.matrix);
      const length = start.distanceTo(end), radius = THIN * this.lines * this.reach;
      line.visible = node.visible && length > 1e-6 * this.reach;
      if (!line.visible) continue;
      line.position.copy(start).add(end).multiplyScalar(0.5);
      line.quaternion.setFromUnitVectors(Z, end.sub(start).normalize());
      line.scale.set(radius, radius, length);
    }
  },
};
