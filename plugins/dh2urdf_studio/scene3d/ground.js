// The ground, and the shadow upon it.
import { THREE } from "nicegui-scene";
import { emptied, styled } from "dh2urdf-scene/shapes.js";

const SUN = new THREE.Vector3(0.32, -0.42, 0.85).normalize(); // from where it shines

export const ground = {
  // The ground is where a robot stands: at its root or, if what its root holds goes deeper, below its lowest link.
  settle() {
    const lowest = (nodes) => {
      const box = new THREE.Box3();
      for (const node of nodes) node.traverse((part) => part.isMesh && part.userData.layer === "links" && box.expandByObject(part));
      return box.isEmpty() ? 0 : box.min.z;
    };
    const deep = lowest(this.nodes.filter(({ userData }) => userData.rooted)) < -0.05 * this.reach;
    this.floor = deep ? Math.min(0, lowest(this.nodes)) : 0;
    this.grid(this.reach);
  },

  grid(reach) {
    this.worn.push(...emptied(this.ground));
    const power = 10 ** Math.floor(Math.log10(reach / 10));
    const step = power * [5, 2, 1].find((times) => times * power <= (1 + 1e-9) * (reach / 10)); // 0.1 m for 1 m to 2 m
    const half = Math.ceil((1.6 * reach) / step) * step;
    const grid = new THREE.GridHelper(2 * half, Math.round((2 * half) / step), styled("grid-axes"), styled("grid"));
    grid.rotateX(Math.PI / 2);
    grid.position.z = this.floor - 0.001 * reach;
    const shadow = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), new THREE.ShadowMaterial({ color: styled("shadow"), opacity: 0.2 }));
    shadow.receiveShadow = true;
    shadow.renderOrder = -1;
    this.ground.add(grid, shadow);
    this.shade();
  },

  // The shadow on the ground is drawn anew with the next picture: the sun sees all that can be seen. What receives it is
  // no larger than what can be in it, as every pixel of that costs time.
  shade() {
    const shadow = this.ground.children[1];
    if (!this.renderer || !shadow) return;
    const points = this.points(), { camera } = this.sun.shadow;
    const { center, radius } = new THREE.Sphere().setFromPoints(points);
    this.sun.target.position.copy(center);
    this.sun.position.copy(SUN).multiplyScalar(4 * radius).add(center);
    [camera.left, camera.right, camera.bottom, camera.top] = [-radius, radius, -radius, radius];
    [camera.near, camera.far] = [radius, 12 * radius];
    camera.updateProjectionMatrix();
    const box = new THREE.Box3().setFromPoints(points.map((point) => point.addScaledVector(SUN, (this.floor - point.z) / SUN.z)));
    box.expandByScalar(0.03 * radius); // its edge is soft
    const [middle, size] = [box.getCenter(new THREE.Vector3()), box.getSize(new THREE.Vector3())];
    shadow.position.set(middle.x, middle.y, this.floor - 0.0015 * this.reach);
    shadow.scale.set(size.x / 2, size.y / 2, 1);
    this.renderer.shadowMap.needsUpdate = true;
  },
};
