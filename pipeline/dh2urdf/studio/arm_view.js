// The scene: nodes with parts, moved by one message that holds all poses. It draws when something has changed, and
// rests when nothing has. `this.$el.scene` is the three.js scene, whose nodes have the names that Python gave them.
import { CSS2DObject, CSS2DRenderer, OrbitControls, THREE } from "nicegui-scene";

const STROKES = { a: 0xd6336c, alpha: 0xe8590c, d: 0x1c7ed6, theta: 0x2f9e44 };
const HIGHLIGHT = new THREE.Color(0x4dabf7);
const AXES = [
  [0xe03131, new THREE.Vector3(1, 0, 0)],
  [0x2f9e44, new THREE.Vector3(0, 1, 0)],
  [0x1c5fd6, new THREE.Vector3(0, 0, 1)],
];

function merged(pieces) {
  // One geometry of several, each with a colour: a frame is one thing to draw.
  const positions = [], normals = [], colours = [];
  for (const [geometry, matrix, colour] of pieces) {
    const flat = geometry.clone().applyMatrix4(matrix).toNonIndexed();
    positions.push(...flat.attributes.position.array);
    normals.push(...flat.attributes.normal.array);
    for (let i = 0; i < flat.attributes.position.count; i++) colours.push(colour.r, colour.g, colour.b);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new THREE.Float32BufferAttribute(normals, 3));
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
  return geometry;
}

function frameGeometry() {
  const up = new THREE.Vector3(0, 1, 0);
  const shaft = new THREE.CylinderGeometry(0.025, 0.025, 0.8, 8).translate(0, 0.4, 0);
  const head = new THREE.ConeGeometry(0.07, 0.2, 12).translate(0, 0.9, 0);
  return merged(
    AXES.flatMap(([colour, direction]) => {
      const turn = new THREE.Matrix4().makeRotationFromQuaternion(
        new THREE.Quaternion().setFromUnitVectors(up, direction),
      );
      return [shaft, head].map((geometry) => [geometry, turn, new THREE.Color(colour)]);
    }),
  );
}

function matrixOf(numbers, at = 0) {
  const [a, b, c, x, d, e, f, y, g, h, i, z] = numbers.slice(at, at + 12);
  return new THREE.Matrix4().set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
}

export default {
  template: `
    <div class="arm-view" role="img" aria-label="The arm in 3D: drag to turn, wheel to come nearer, right button to move">
      <canvas></canvas>
      <div class="arm-view-labels"></div>
      <div v-if="fault" class="arm-view-fault">{{ fault }}</div>
    </div>`,

  data: () => ({ fault: "" }),

  created() {
    // Not reactive: three.js has its own ideas of objects.
    this.layers = new Set(["links", "axes", "frames"]);
    this.nodes = [];
    this.geometries = {
      box: new THREE.BoxGeometry(1, 1, 1),
      cylinder: new THREE.CylinderGeometry(1, 1, 1, 32).rotateX(Math.PI / 2),
      sphere: new THREE.SphereGeometry(1, 32, 16),
      frame: frameGeometry(),
    };
    this.reach = 0;
    this.row = null;
  },

  mounted() {
    this.scene = new THREE.Scene();
    this.arm = new THREE.Group();
    this.strokes = new THREE.Group();
    this.ground = new THREE.Group();
    this.scene.add(this.arm, this.strokes, this.ground);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a94a6, 2.2));
    const sun = new THREE.DirectionalLight(0xffffff, 1.6);
    sun.position.set(3, -4, 8);
    this.scene.add(sun);
    this.camera = new THREE.PerspectiveCamera(36, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.$el.scene = this.scene;
    this.$el.camera = this.camera;
    const canvas = this.$el.querySelector("canvas");
    try {
      this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, canvas });
    } catch {
      this.fault = "This browser gives no WebGL, so the arm cannot be drawn. Everything else works.";
    }
    this.labels = new CSS2DRenderer({ element: this.$el.querySelector(".arm-view-labels") });
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    canvas.addEventListener("dblclick", (event) => this.pick(event));
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.$el);
    this.resize();
    this.look(1.0);
  },

  beforeUnmount() {
    this.observer.disconnect();
    this.controls.dispose();
    this.renderer?.dispose();
  },

  methods: {
    // A drawing takes the place of the one before; see Drawing.as_json.
    show(drawing, poses) {
      for (const node of this.nodes) {
        node.traverse((object) => object.isCSS2DObject && object.element.remove());
        node.traverse((object) => object.material?.dispose());
      }
      this.arm.clear();
      this.nodes = drawing.nodes.map((node) => this.node(node));
      for (const node of this.nodes) this.arm.add(node);
      if (Math.abs(Math.log(drawing.reach / (this.reach || 1e-9))) > 0.7) this.look(drawing.reach);
      this.move(poses);
      this.highlight(this.row);
      this.$el.shown = (this.$el.shown ?? 0) + 1;
    },

    // Every node's pose, and the DH parameters where they are shown; see poses_as_json.
    move({ poses, strokes }) {
      this.nodes.forEach((node, index) => {
        node.matrix.copy(matrixOf(poses, 12 * index));
        node.matrixWorldNeedsUpdate = true;
      });
      this.strokes.traverse((object) => object.isCSS2DObject && object.element.remove());
      this.strokes.traverse((object) => (object.geometry?.dispose(), object.material?.dispose()));
      this.strokes.clear();
      for (const stroke of strokes) this.strokes.add(this.stroke(stroke));
      this.draw();
    },

    node({ name, row, label, layer, parts }) {
      const node = new THREE.Group();
      node.name = name;
      node.matrixAutoUpdate = false;
      node.userData.row = row;
      for (const part of parts) node.add(this.part(part));
      if (label) node.add(this.label(label, layer, `arm-view-label arm-view-${layer}-label`));
      return node;
    },

    part({ shape, size, pose, layer, colour, opacity }) {
      const material = new THREE.MeshStandardMaterial({
        color: shape === "frame" ? 0xffffff : new THREE.Color(...colour).convertSRGBToLinear(),
        vertexColors: shape === "frame",
        roughness: 0.55,
        metalness: 0.05,
        transparent: opacity < 1,
        opacity,
        depthWrite: opacity === 1,
      });
      if (layer === "frames" || layer === "axes") {
        material.emissive = new THREE.Color(0x333333); // a little light of its own: it is a sign, not a thing
        material.depthTest = false; // and seen through the link that it is in
        material.transparent = true;
      }
      const mesh = new THREE.Mesh(this.geometries[shape], material);
      const [x, y, z] = shape === "box" ? size : shape === "cylinder" ? [size[0], size[0], size[1]] : Array(3).fill(size[0]);
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(matrixOf(pose)).scale(new THREE.Vector3(x, y, z));
      mesh.renderOrder = { axes: 1, frames: 2 }[layer] ?? 0;
      mesh.userData.layer = layer;
      mesh.visible = this.layers.has(layer);
      return mesh;
    },

    label(text, layer, classes) {
      const element = document.createElement("div");
      element.textContent = text;
      element.className = classes;
      const label = new CSS2DObject(element);
      label.center.set(-0.15, 1.1);
      label.userData.layer = layer;
      label.visible = this.layers.has(layer);
      return label;
    },

    stroke({ row, field, points, label }) {
      const path = new THREE.CurvePath();
      const vectors = points.map((point) => new THREE.Vector3(...point));
      for (let i = 1; i < vectors.length; i++) path.add(new THREE.LineCurve3(vectors[i - 1], vectors[i]));
      const radius = 0.006 * this.reach;
      const material = new THREE.MeshBasicMaterial({ color: STROKES[field], depthTest: false, transparent: true });
      const tube = new THREE.Mesh(new THREE.TubeGeometry(path, Math.max(1, 2 * (vectors.length - 1)), radius, 6), material);
      tube.renderOrder = 3;
      tube.userData.row = row;
      tube.name = `${field} ${row + 1}`;
      const text = this.label(label, "parameters", `arm-view-label arm-view-stroke arm-view-${field}`);
      text.position.copy(vectors.length > 2 ? vectors[Math.floor(vectors.length / 2)] : vectors[0].clone().lerp(vectors[1], 0.5));
      tube.add(text);
      this.emphasise(tube);
      return tube;
    },

    // Where a row is picked, only its own parameters are told.
    emphasise(tube) {
      const on = this.row === null || tube.userData.row === this.row;
      tube.material.opacity = on ? 1 : 0.3;
      tube.children[0].visible = on;
    },

    setLayers(layers) {
      this.layers = new Set(layers);
      this.arm.traverse((object) => {
        if (object.userData.layer) object.visible = this.layers.has(object.userData.layer);
      });
      this.draw();
    },

    // The link and the frame of a row stand out; null for none.
    highlight(row) {
      this.row = row;
      for (const tube of this.strokes.children) this.emphasise(tube);
      for (const node of this.nodes) {
        const on = row !== null && node.userData.row === row;
        node.traverse((object) => {
          if (object.isMesh && object.userData.layer === "links") {
            object.material.emissive = on ? HIGHLIGHT : new THREE.Color(0);
            object.material.emissiveIntensity = on ? 0.5 : 1;
          } else if (object.isMesh && object.userData.layer === "frames") {
            object.material.opacity = row === null || on ? 1 : 0.35;
          } else if (object.isCSS2DObject) {
            object.element.classList.toggle("arm-view-picked", on);
          }
        });
      }
      this.draw();
    },

    // The camera where it sees all of an arm of this reach.
    look(reach) {
      this.reach = reach;
      const far = 2.9 * reach;
      this.camera.position.set(0.62 * far, -0.62 * far, 0.5 * far);
      this.camera.near = far / 200;
      this.camera.far = far * 20;
      this.camera.updateProjectionMatrix();
      this.controls.target.set(0, 0, 0.25 * reach);
      this.controls.update();
      this.grid(reach);
      this.draw();
    },

    fit() {
      this.scene.updateMatrixWorld();
      const box = new THREE.Box3();
      for (const node of this.nodes)
        node.traverse((object) => object.isMesh && object.userData.layer === "links" && box.expandByObject(object));
      this.look(this.reach);
      if (box.isEmpty()) return;
      box.expandByScalar(0.06 * this.reach);
      const centre = box.getCenter(new THREE.Vector3());
      const away = this.camera.position.clone().sub(this.controls.target).normalize();
      const right = new THREE.Vector3().crossVectors(this.camera.up, away).normalize();
      const up = new THREE.Vector3().crossVectors(away, right);
      const tall = Math.tan((this.camera.fov * Math.PI) / 360);
      // Every corner has to be inside the picture: behind the nearest plane that shows it.
      let distance = 0;
      for (let i = 0; i < 8; i++) {
        const corner = new THREE.Vector3(...["x", "y", "z"].map((axis, bit) => box[(i >> bit) & 1 ? "max" : "min"][axis])).sub(centre);
        const aside = Math.max(Math.abs(corner.dot(right)) / (tall * this.camera.aspect), Math.abs(corner.dot(up)) / tall);
        distance = Math.max(distance, corner.dot(away) + 1.12 * aside);
      }
      this.controls.target.copy(centre);
      this.camera.position.copy(centre).addScaledVector(away, distance);
      this.controls.update();
      this.draw();
    },

    grid(reach) {
      this.ground.traverse((object) => (object.geometry?.dispose(), object.material?.dispose()));
      this.ground.clear();
      const step = 10 ** Math.floor(Math.log10(reach / 2)); // 0.1 m for an arm of 0.2 m to 2 m
      const half = Math.ceil((1.6 * reach) / step) * step;
      const grid = new THREE.GridHelper(2 * half, Math.round((2 * half) / step), 0x7c8ba1, 0xc3cfdd);
      grid.rotateX(Math.PI / 2);
      grid.position.z = -0.001 * reach;
      this.ground.add(grid);
    },

    pick(event) {
      const canvas = event.currentTarget.getBoundingClientRect();
      const caster = new THREE.Raycaster();
      const x = (2 * (event.clientX - canvas.left)) / canvas.width - 1;
      const y = 1 - (2 * (event.clientY - canvas.top)) / canvas.height;
      caster.setFromCamera(new THREE.Vector2(x, y), this.camera);
      const hit = caster.intersectObjects(this.nodes, true).find(({ object }) => object.visible && object.isMesh);
      let node = hit?.object;
      while (node && node.userData.row === undefined) node = node.parent;
      this.$emit("pick", { row: node?.userData.row ?? null });
    },

    resize() {
      const { clientWidth: width, clientHeight: height } = this.$el;
      if (!width || !height) return;
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      this.renderer?.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      this.renderer?.setSize(width, height);
      this.labels.setSize(width, height);
      this.draw();
    },

    draw() {
      if (this.waiting) return;
      this.waiting = true;
      requestAnimationFrame(() => {
        this.waiting = false;
        this.scene.updateMatrixWorld();
        this.renderer?.render(this.scene, this.camera);
        this.labels.render(this.scene, this.camera);
        this.$el.drawn = (this.$el.drawn ?? 0) + 1;
      });
    },
  },
};
