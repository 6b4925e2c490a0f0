// Mesh files: their triangles and textures, each asked for once.
import { THREE } from "nicegui-scene";
import { matrixOf } from "dh2urdf-scene/shapes.js";

const WHITE = [1, 1, 1]; // what a texture is multiplied by
const PACE = 1000; // between pictures while meshes are on their way [ms]

// What a mesh file holds, as `triangles` of drawing/mesh_files.py sends it: a geometry for each colour and texture.
async function triangles(address, picture, report) {
  const answer = await fetch(address);
  if (!answer.ok) throw new Error(await answer.text());
  const bytes = await answer.arrayBuffer();
  const length = new DataView(bytes).getUint32(0, true);
  const { parts, unread } = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  if (unread.length) report(unread.join("\n"));
  let at = 4 + length;
  const take = (kind, count) => {
    const taken = new kind(bytes, at, count);
    at += taken.byteLength;
    return taken;
  };
  return Promise.all(parts.map(async ({ rgba, vertices, corners, texture }) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(take(Float32Array, 3 * vertices), 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(take(Int8Array, 4 * vertices), 4, true));
    if (texture) geometry.setAttribute("uv", new THREE.BufferAttribute(take(Float32Array, 2 * vertices), 2));
    geometry.setIndex(new THREE.BufferAttribute(take(Uint32Array, corners), 1));
    geometry.computeBoundingBox();
    return { rgba, geometry, map: texture ? await picture(texture) : undefined };
  }));
}

export const meshes = {
  // A mesh file: its triangles come in their own time, once for all parts that show it, and when their layer is shown.
  mesh(key, pose, layer, { colour, opacity, ownColours }, number) {
    const group = new THREE.Group();
    group.matrixAutoUpdate = false;
    group.matrix.copy(matrixOf(pose));
    const load = () => {
      if (!this.meshes.has(key)) {
        const report = (message) => this.$emit("undrawn", { message });
        const refuse = (error) => (report(error.message), []);
        this.meshes.set(key, triangles(`meshes/${key}`, (texture) => this.picture(texture, report), report).catch(refuse));
      }
      if (!this.waiting) this.nextLook = performance.now() + PACE;
      this.waiting += 1;
      this.meshes.get(key).then((parts) => {
        for (const { rgba, geometry, map } of parts) {
          const painted = !(ownColours && (rgba || map)); // else it has the colour of its file
          const [own, clear] = [painted ? colour : (rgba?.slice(0, 3) ?? WHITE), opacity * (painted ? 1 : (rgba?.[3] ?? 1))];
          const mesh = new THREE.Mesh(geometry, this.material("mesh", layer, own, clear, number));
          if (!painted && layer === "links") mesh.material.map = map ?? null;
          mesh.userData = { layer, shared: true };
          mesh.visible = this.layers.has(layer);
          mesh.castShadow = layer === "links";
          group.add(mesh);
        }
        if (group.parent) this.veil(group.parent);
        this.arrived();
      });
    };
    if (this.layers.has(layer)) load();
    else group.userData.waits = { layer, load };
    return group;
  },

  // A texture, once for all meshes that have it; null where the browser cannot show it.
  picture(key, report) {
    if (!this.textures.has(key)) {
      const shown = (texture) => Object.assign(texture, { colorSpace: THREE.SRGBColorSpace, wrapS: THREE.RepeatWrapping, wrapT: THREE.RepeatWrapping, anisotropy: 4 });
      const refuse = () => (report("the browser cannot show a texture"), null);
      this.textures.set(key, new THREE.TextureLoader().loadAsync(`textures/${key}`).then(shown, refuse));
    }
    return this.textures.get(key);
  },

  // A mesh is there. Those before the last one are drawn now and then only, as a picture of many triangles can take as
  // long as a file. After the last one the camera sees all, if a person has not turned it meanwhile.
  arrived() {
    this.loaded += 1;
    const isLast = this.loaded >= this.waiting;
    if (isLast) {
      this.waiting = this.loaded = 0;
      this.settle();
      if (!this.own && !this.seen()) this.fit(true);
    }
    if (!isLast && performance.now() < this.nextLook) return;
    this.nextLook = performance.now() + PACE;
    this.shade();
    this.draw();
  },
};
