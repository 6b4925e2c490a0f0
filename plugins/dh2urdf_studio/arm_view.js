// The scene: nodes with parts, moved by one message that holds all poses. It draws when something has changed, and
// rests when nothing has. `this.$el.scene` is the three.js scene, whose nodes have the names that Python gave them.
import { OrbitControls, THREE } from "nicegui-scene";
import { meshes } from "dh2urdf-scene/meshes.js";
import { camera } from "dh2urdf-scene/camera.js";
import { projection } from "dh2urdf-scene/projection.js";
import { labels } from "dh2urdf-scene/labels.js";
import { frameLines } from "dh2urdf-scene/frame_lines.js";
import { strokes } from "dh2urdf-scene/strokes.js";
import { pictures } from "dh2urdf-scene/pictures.js";
import { ground } from "dh2urdf-scene/ground.js";
import { outlines } from "dh2urdf-scene/outlines.js";
import { axisCross } from "dh2urdf-scene/axis_cross.js";
import { dragging } from "dh2urdf-scene/dragging.js";
import { emptied, frameGeometry, matrixOf, styled } from "dh2urdf-scene/shapes.js";

const THINNEST = 0.004; // radius that a link is drawn with at least, in reaches of the arm
const SOFT = 1024; // side of the map of shadows [px]

export default {
  template: `
    <div class="arm-view" role="application" tabindex="0" @keydown="key"
         aria-label="The arm in 3D: drag or use the arrow keys to turn, wheel or + and - to come nearer, right button to move, 0 to see all; 1 is the view from the front, 3 from the right, 7 from above, 9 from a corner, 5 changes between perspective and orthographic">
      <canvas></canvas>
      <svg class="arm-view-leaders" aria-hidden="true"><path/></svg>
      <div class="arm-view-labels"></div>
      <button type="button" tabindex="-1" class="arm-view-projection" :aria-pressed="parallel" title="parallel rays, as in a drawing; 5 in the scene"
              @click="project(!parallel)" @pointerdown.stop @dblclick.stop>orthographic</button>
      <button v-if="quick" type="button" tabindex="-1" class="arm-view-quick" @click="smooth" @pointerdown.stop @dblclick.stop
              title="This browser draws without a graphics card. So that it draws quickly, edges are not smooth; a click makes them smooth.">drawn in software</button>
      <svg class="arm-view-cross" viewBox="-36 -36 72 72" aria-hidden="true"></svg>
      <div v-if="waiting" class="arm-view-progress">
        meshes: {{ loaded }} of {{ waiting }} <progress :max="waiting" :value="loaded" aria-label="meshes"></progress>
      </div>
      <div v-if="fault" class="arm-view-fault">{{ fault }}</div>
    </div>`,

  data: () => ({ fault: "", waiting: 0, loaded: 0, parallel: dhLook.isOrthographic(), quick: !dhLook.isSmooth() && dhLook.drawsInSoftware() }),

  created() {
    // Not reactive: three.js has its own ideas of objects.
    this.layers = new Set(["links", "axes", "frames", "outlines"]);
    this.meshes = new Map(); // by their keys, promises of what mesh files hold
    this.textures = new Map(); // and of the pictures on them
    this.nodes = [];
    this.worn = []; // what can be disposed of after the next picture
    this.geometries = {
      box: new THREE.BoxGeometry(1, 1, 1),
      cylinder: new THREE.CylinderGeometry(1, 1, 1, 32).rotateX(Math.PI / 2),
      rod: new THREE.CylinderGeometry(1, 1, 1, 8).rotateX(Math.PI / 2), // thin and not lit: nobody sees its edges
      sphere: new THREE.SphereGeometry(1, 32, 16),
      frame: frameGeometry(),
    };
    for (const geometry of Object.values(this.geometries)) geometry.computeBoundingBox();
    this.reach = 1;
    this.floor = 0; // where the ground is [m]
    this.row = null;
    this.link = null; // the name of a node that stands out, instead of those of a row
    this.hidden = new Set(); // names of nodes
    this.lines = Number(styled("lines")) || 1; // thickness of lines
    this.isSmooth = dhLook.isSmooth(); // whether the canvas has smooth edges
    this.faded = {}; // how much less opaque the bodies of robots are than they would be, by the names of the robots
    this.goal = null; // where the camera is going by itself
    this.holding = false; // whether a person holds the camera
    this.followsPicked = false; // whether the camera moves with the picked node
    this.pickedAt = null; // where that node was
    this.nextLook = 0; // when meshes that are on their way are drawn next [ms]
    this.own = false; // whether a person looks at a part of the arm, and wants to go on looking there
  },

  mounted() {
    this.scene = new THREE.Scene();
    this.arm = new THREE.Group();
    this.strokes = new THREE.Group();
    this.ground = new THREE.Group();
    this.cloud = new THREE.Group();
    this.frameLines = new THREE.Group();
    this.scene.add(this.arm, this.strokes, this.ground, this.cloud, this.frameLines);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a94a6, 2.2));
    this.sun = new THREE.DirectionalLight(0xffffff, 1.6);
    this.sun.position.set(3, -4, 8);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(SOFT, SOFT);
    this.sun.shadow.radius = 5;
    this.scene.add(this.sun, this.sun.target);
    this.looks = () => this.dress();
    window.addEventListener("dh-look", this.looks);
    this.camera = new THREE.PerspectiveCamera(36, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.level = new THREE.OrthographicCamera();
    this.$el.scene = this.scene;
    this.$el.camera = this.camera;
    const canvas = this.$el.querySelector("canvas");
    try {
      this.renderer = new THREE.WebGLRenderer({ antialias: this.isSmooth, alpha: true, stencil: true, canvas });
      this.renderer.shadowMap.enabled = true;
      this.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
      this.renderer.shadowMap.autoUpdate = false; // it is drawn anew when something has moved
    } catch {
      this.fault = "This browser gives no WebGL, so the arm cannot be drawn. Everything else works.";
    }
    this.sheet = this.$el.querySelector(".arm-view-labels");
    this.cube = dhCube(this.$el, (from) => this.lookFrom(from));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => ((this.holding = true), (this.goal = null)));
    this.controls.addEventListener("end", () => ((this.holding = false), (this.own = !this.seen())));
    canvas.addEventListener("dblclick", (event) => this.pick(event));
    const ball = new THREE.MeshBasicMaterial({ color: 0xae3ec9, transparent: true, opacity: 0.55, depthTest: false });
    this.handle = new THREE.Mesh(this.geometries.sphere, ball);
    this.handle.name = "handle";
    this.handle.renderOrder = 4;
    this.handle.visible = false;
    this.scene.add(this.handle);
    canvas.addEventListener("pointerdown", (event) => this.take(event), true); // before it turns the camera
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => this.release());
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.$el);
    this.resize();
    this.fit();
    this.rehearse();
  },

  beforeUnmount() {
    window.removeEventListener("dh-look", this.looks);
    this.observer.disconnect();
    this.controls.dispose();
    this.renderer?.dispose();
  },

  methods: {
    ...meshes,
    ...camera,
    ...projection,
    ...labels,
    ...strokes,
    ...frameLines,
    ...pictures,
    ...ground,
    ...outlines,
    ...dragging,
    ...axisCross,

    // A drawing takes the place of the one before; see Drawing.as_json.
    show(drawing, poses) {
      this.shownNow = [drawing, poses];
      this.reach = drawing.reach;
      this.tool = drawing.tool;
      this.worn.push(...emptied(this.arm));
      this.nodes = drawing.nodes.map((node, number) => this.node(node, number));
      for (const node of this.nodes) this.arm.add(node);
      this.layLines();
      this.move(poses);
      if (!this.waiting) this.settle();
      const another = Math.abs(Math.log(this.reach / this.fitted)) > 0.5;
      if (another || (!this.own && !this.seen())) this.fit(true);
      this.hide(this.hidden);
      this.highlight(this.row, this.link);
      this.$el.shown = (this.$el.shown ?? 0) + 1;
    },

    // Every node's pose, and the DH parameters where they are shown; see poses_as_json.
    move({ poses, strokes }) {
      if (this.shownNow) this.shownNow[1] = { poses, strokes };
      this.nodes.forEach((node, index) => {
        node.matrix.copy(matrixOf(poses, 12 * index));
        node.matrixWorldNeedsUpdate = true;
      });
      this.worn.push(...emptied(this.strokes));
      for (const stroke of strokes) this.strokes.add(this.stroke(stroke));
      const tool = this.nodes.find((node) => node.name === this.tool);
      if (tool) this.handle.position.setFromMatrixPosition(tool.matrix);
      this.handle.scale.setScalar(0.035 * this.reach);
      this.stretch();
      this.keepPicked();
      this.follow();
      this.shade();
      this.draw();
    },

    node({ name, row, figure, grip, carrier, label, layer, rooted, parts }, number) {
      const node = new THREE.Group();
      node.name = name;
      node.matrixAutoUpdate = false;
      node.userData = { row, figure, grip, carrier, rooted };
      for (const part of parts) node.add(this.part(part, number));
      this.veil(node);
      if (label) node.add(this.label(label, layer, `arm-view-${layer}-label`));
      return node;
    },

    material(shape, layer, colour, opacity, number) {
      const sign = ["frames", "axes", "masses"].includes(layer); // not a thing: not lit, and seen through the link that it is in
      return new (sign ? THREE.MeshBasicMaterial : THREE.MeshLambertMaterial)({
        color: shape === "frame" ? 0xffffff : new THREE.Color(...colour).convertSRGBToLinear(),
        vertexColors: shape === "frame",
        transparent: sign || opacity < 1,
        opacity,
        depthWrite: opacity === 1,
        depthTest: !sign,
        // A collision shape is nearer than the link's own face, which often is the same; of links in one place the later
        // one is, so that they do not flicker.
        polygonOffset: !sign,
        polygonOffsetFactor: layer === "collision" ? -1 : 0,
        polygonOffsetUnits: -4 * (number % 8) - (layer === "collision" ? 4 : 0),
      });
    },

    part({ shape, size, pose, layer, colour, opacity, mesh: key, ownColours }, number) {
      if (shape === "mesh") return this.mesh(key, pose, layer, { colour, opacity, ownColours }, number);
      const mesh = new THREE.Mesh(this.geometries[layer === "axes" ? "rod" : shape], this.material(shape, layer, colour, opacity, number));
      const thin = layer === "links" ? THINNEST * this.reach : 0; // else the links of a very long arm are less than a pixel
      const thick = ["axes", "frames"].includes(layer) ? Math.sqrt(this.lines) : 1;
      const [x, y, z] = shape === "box" ? size.map((side) => Math.max(side, thin)) : shape === "cylinder" ? [Math.max(size[0], thin), Math.max(size[0], thin), size[1]] : size.length === 3 ? size : Array(3).fill(size[0]);
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(matrixOf(pose)).scale(new THREE.Vector3(thick * x, thick * y, layer === "axes" ? z : thick * z));
      mesh.renderOrder = { axes: 1, masses: 1, frames: 3 }[layer] ?? 0; // strokes are between them
      mesh.userData = { layer, shared: true }; // its geometry is that of all parts of its shape
      mesh.castShadow = layer === "links";
      mesh.visible = this.layers.has(layer);
      return mesh;
    },

    setLayers(layers) {
      this.layers = new Set(layers);
      this.arm.traverse((object) => {
        const { layer, waits } = object.userData;
        if (layer) object.visible = this.layers.has(layer);
        if (waits && this.layers.has(waits.layer)) {
          delete object.userData.waits;
          waits.load();
        }
      });
      this.highlight(this.row, this.link);
      this.stretch();
      this.shade();
      this.draw();
    },

    // The nodes of these names are not shown.
    hide(names) {
      this.hidden = new Set(names);
      for (const node of this.nodes) node.visible = !this.hidden.has(node.name);
      this.stretch();
      this.shade();
      this.draw();
    },

    // How opaque the bodies of robots are, by the names of the robots: 1 as their descriptions have it.
    fade(faded) {
      this.faded = faded;
      for (const node of this.nodes) this.veil(node);
      this.draw();
    },

    veil(node) {
      const share = this.faded[node.userData.figure] ?? 1;
      node.traverse(({ isMesh, material, userData }) => {
        if (!isMesh || userData.layer !== "links" || userData.outline) return;
        material.userData.opacity ??= material.opacity;
        const opacity = share * material.userData.opacity;
        material.needsUpdate ||= material.transparent !== opacity < 1; // shaders differ
        Object.assign(material, { opacity, transparent: opacity < 1, depthWrite: opacity === 1 });
      });
    },

    // The colours of the ground and the thickness of lines as the style sheet has them now.
    dress() {
      this.lines = Number(styled("lines")) || 1;
      this.measured = null; // the page has another size of text
      if (this.shownNow) this.show(...this.shownNow);
      if (this.fitted) this.grid(this.fitted);
      this.draw();
    },

    // Points of tool0, three numbers each, in place of those before.
    showCloud(numbers) {
      this.worn.push(...emptied(this.cloud));
      if (numbers.length) {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.Float32BufferAttribute(numbers, 3));
        const material = new THREE.PointsMaterial({ color: 0x1c7ed6, size: 2.5, sizeAttenuation: false, transparent: true, opacity: 0.55 });
        const points = new THREE.Points(geometry, material);
        geometry.computeBoundingBox();
        points.name = "workspace";
        this.cloud.add(points);
        if (!this.own) this.fit(true);
      }
      this.draw();
    },

    resize() {
      const { clientWidth: width, clientHeight: height } = this.$el;
      if (!width || !height) return;
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      this.renderer?.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      this.renderer?.setSize(width, height);
      this.measured = null;
      if (!this.own) this.fit(true);
      this.draw();
    },

    smooth: () => dhLook.smooth(),

    // Waits for the next picture, or for a page that draws none.
    nextPicture() {
      return new Promise((done) => requestAnimationFrame(() => done()));
    },

    draw() {
      if (this.pending) return;
      this.pending = true;
      requestAnimationFrame(() => {
        this.pending = false;
        this.glide();
        this.scene.updateMatrixWorld();
        this.$el.camera = this.eye();
        this.renderer?.render(this.scene, this.$el.camera);
        for (const held of this.worn.splice(0)) held.dispose();
        this.cube.turn(this.camera);
        this.place();
        this.cross();
        this.$el.goes = Boolean(this.goal); // whether the camera is on its way
        this.$el.drawn = (this.$el.drawn ?? 0) + 1;
      });
    },
  },
};
