// The scene: nodes with parts, moved by one message that holds all poses. It draws when something has changed, and
// rests when nothing has. `this.$el.scene` is the three.js scene, whose nodes have the names that Python gave them.
import { OrbitControls, THREE } from "nicegui-scene";

const STROKES = { a: 0xd6336c, alpha: 0xe8590c, d: 0x1c7ed6, theta: 0x2f9e44, x: 0xe03131, y: 0x2f9e44, z: 0x1971c2, distance: 0x495057, line: 0x868e96, normal: 0xc2255c, offset: 0x1971c2, foot: 0x212529 };
const OUTLINE = 0.0045; // width of the line around a picked link, in reaches of the arm
const MARKED = 1; // what the stencil holds where the picked link is
const SUN = new THREE.Vector3(0.32, -0.42, 0.85).normalize(); // from where it shines
const SOFT = 1024; // side of the map of shadows [px]
const THINNEST = 0.004; // radius that a link is drawn with at least, in reaches of the arm
const GREY = [0.72, 0.74, 0.77]; // of a mesh without a colour
const WHITE = [1, 1, 1]; // what a texture is multiplied by
const STEP = Math.PI / 36; // of an arrow key [rad]
const MARGIN = 34; // of the picture, for labels [px]
const FROM = new THREE.Vector3(0.62, -0.62, 0.5).normalize(); // where the camera stands first, seen from the arm
const VIEWS = { front: [1, 0, 0], back: [-1, 0, 0], right: [0, -1, 0], left: [0, 1, 0], top: [0, 0, 1], bottom: [0, 0, -1], corner: FROM.toArray() }; // from where they look
const KEYS = { 1: "front", 3: "right", 7: "top", 9: "corner" }; // where modellers have them on the number pad
const ROWS = [-1, 0, -2, 1, -3, 2, -4, 3]; // of a label above and below its point, in its own heights
const UP = new THREE.Vector3(0, 1, 0); // along which three.js lays cylinders and cones
const AXES = [
  [0xf01414, new THREE.Vector3(1, 0, 0)],
  [0x0ca524, new THREE.Vector3(0, 1, 0)],
  [0x1450ff, new THREE.Vector3(0, 0, 1)],
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
  const arrow = (more) => [
    new THREE.CylinderGeometry(0.035 + more, 0.035 + more, 0.78 + more, 8).translate(0, 0.39, 0),
    new THREE.ConeGeometry(0.095 + 1.5 * more, 0.24 + 3.5 * more, 12).translate(0, 0.88 + 0.5 * more, 0),
  ];
  const arrows = (more, painted) =>
    AXES.flatMap(([colour, direction]) => {
      const turn = new THREE.Matrix4().makeRotationFromQuaternion(new THREE.Quaternion().setFromUnitVectors(UP, direction));
      return arrow(more).map((geometry) => [geometry, turn, new THREE.Color(painted ?? colour)]);
    });
  return merged([...arrows(0.018, 0xffffff), ...arrows(0)]); // a white rim under the colours, whatever is behind them
}

// Takes everything out of a group, and its labels from the page. What the graphics card holds is given to be disposed
// of later: once the next picture is drawn, so that a shader which that one needs too is not compiled anew.
function emptied(group) {
  const held = [];
  group.traverse(({ userData, geometry, material }) => {
    userData.element?.remove();
    if (material) held.push(material);
    if (geometry && !userData.shared) held.push(geometry);
  });
  group.clear();
  return held;
}

// What a mesh file holds, as `triangles` of drawing/mesh_files.py sends it: a geometry for each colour and texture.
async function triangles(address, picture, report) {
  const answer = await fetch(address);
  if (!answer.ok) throw new Error(await answer.text());
  const bytes = await answer.arrayBuffer();
  const length = new DataView(bytes).getUint32(0, true);
  const { parts, unread } = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  if (unread.length) report(unread.join("\n"));
  let at = 4 + length;
  return Promise.all(parts.map(async ({ rgba, corners, texture }) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(bytes, at, 3 * corners), 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(new Int8Array(bytes, at + 12 * corners, 4 * corners), 4, true));
    geometry.computeBoundingBox();
    at += 16 * corners;
    if (!texture) return { rgba, geometry };
    geometry.setAttribute("uv", new THREE.BufferAttribute(new Float32Array(bytes, at, 2 * corners), 2));
    at += 8 * corners;
    return { rgba, geometry, map: await picture(texture) };
  }));
}

// A colour or a number of the style sheet, which differs between light, dark and projector.
const styled = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

function matrixOf(numbers, at = 0) {
  const [a, b, c, x, d, e, f, y, g, h, i, z] = numbers.slice(at, at + 12);
  return new THREE.Matrix4().set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
}

export default {
  template: `
    <div class="arm-view" role="application" tabindex="0" @keydown="key"
         aria-label="The arm in 3D: drag or use the arrow keys to turn, wheel or + and - to come nearer, right button to move, 0 to see all; 1 is the view from the front, 3 from the right, 7 from above, 9 from a corner">
      <canvas></canvas>
      <div class="arm-view-labels"></div>
      <div v-if="waiting" class="arm-view-progress">
        meshes: {{ loaded }} of {{ waiting }} <progress :max="waiting" :value="loaded" aria-label="meshes"></progress>
      </div>
      <div v-if="fault" class="arm-view-fault">{{ fault }}</div>
    </div>`,

  data: () => ({ fault: "", waiting: 0, loaded: 0 }),

  created() {
    // Not reactive: three.js has its own ideas of objects.
    this.layers = new Set(["links", "axes", "frames"]);
    this.meshes = new Map(); // by their keys, promises of what mesh files hold
    this.textures = new Map(); // and of the pictures on them
    this.nodes = [];
    this.worn = []; // what can be disposed of after the next picture
    this.geometries = {
      box: new THREE.BoxGeometry(1, 1, 1),
      cylinder: new THREE.CylinderGeometry(1, 1, 1, 32).rotateX(Math.PI / 2),
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
    this.own = false; // whether a person looks at a part of the arm, and wants to go on looking there
  },

  mounted() {
    this.scene = new THREE.Scene();
    this.arm = new THREE.Group();
    this.strokes = new THREE.Group();
    this.ground = new THREE.Group();
    this.cloud = new THREE.Group();
    this.scene.add(this.arm, this.strokes, this.ground, this.cloud);
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
    this.$el.scene = this.scene;
    this.$el.camera = this.camera;
    const canvas = this.$el.querySelector("canvas");
    try {
      this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, stencil: true, canvas });
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
    this.controls.addEventListener("end", () => (this.own = !this.seen()));
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
    // A drawing takes the place of the one before; see Drawing.as_json.
    show(drawing, poses) {
      this.shownNow = [drawing, poses];
      this.reach = drawing.reach;
      this.worn.push(...emptied(this.arm));
      this.nodes = drawing.nodes.map((node, number) => this.node(node, number));
      for (const node of this.nodes) this.arm.add(node);
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
      const tool0 = this.nodes.find((node) => node.name === "tool0");
      if (tool0) this.handle.position.setFromMatrixPosition(tool0.matrix);
      this.handle.scale.setScalar(0.035 * this.reach);
      if (this.handle.visible && !this.plane && !this.within([this.handle.position.clone()])) this.fit(true);
      this.shade();
      this.draw();
    },

    node({ name, row, label, layer, rooted, parts }, number) {
      const node = new THREE.Group();
      node.name = name;
      node.matrixAutoUpdate = false;
      node.userData = { row, rooted };
      for (const part of parts) node.add(this.part(part, number));
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
      const mesh = new THREE.Mesh(this.geometries[shape], this.material(shape, layer, colour, opacity, number));
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
        this.waiting += 1;
        this.meshes.get(key).then((parts) => {
          for (const { rgba, geometry, map } of parts) {
            const painted = colour && !(ownColours && (rgba || map)); // else it has the colour of its file
            const [own, clear] = [painted ? colour : (rgba?.slice(0, 3) ?? (map ? WHITE : GREY)), opacity * (painted ? 1 : (rgba?.[3] ?? 1))];
            const mesh = new THREE.Mesh(geometry, this.material("mesh", layer, own, clear, number));
            if (!painted && layer === "links") mesh.material.map = map ?? null;
            mesh.userData = { layer, shared: true };
            mesh.visible = this.layers.has(layer);
            mesh.castShadow = layer === "links";
            group.add(mesh);
          }
          this.arrived();
          this.shade();
          this.draw();
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

    // A part of a mesh file is there; after the last one the camera sees all, if a person has not turned it meanwhile.
    arrived() {
      this.loaded += 1;
      if (this.loaded < this.waiting) return;
      this.waiting = this.loaded = 0;
      this.settle();
      if (!this.own && !this.seen()) this.fit(true);
    },

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
      this.shade();
      this.draw();
    },

    // The nodes of these names are not shown.
    hide(names) {
      this.hidden = new Set(names);
      for (const node of this.nodes) node.visible = !this.hidden.has(node.name);
      this.shade();
      this.draw();
    },

    // The colours of the ground and the thickness of lines as the style sheet has them now.
    dress() {
      this.lines = Number(styled("lines")) || 1;
      if (this.shownNow) this.show(...this.shownNow);
      if (this.fitted) this.grid(this.fitted);
      this.draw();
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

    // Draws a link, an axis and a frame that are picked, before there are any: a picture waits for the shaders of what it
    // is the first to show, and that is not to be the picture after the first key. Its materials are kept, and so they are.
    rehearse() {
      if (!this.renderer) return;
      const pose = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
      this.rehearsed = new THREE.Group();
      for (const [layer, shape] of [["links", "cylinder"], ["axes", "cylinder"], ["frames", "frame"]])
        this.rehearsed.add(this.part({ shape, size: [1e-3, 1e-3, 1e-3], pose, layer, colour: [1, 1, 1], opacity: 1 }, 0));
      this.outline(this.rehearsed);
      this.rehearsed.position.copy(this.controls.target);
      this.scene.add(this.rehearsed);
      this.renderer.render(this.scene, this.camera);
      this.rehearsed.removeFromParent();
    },

    // A line around a link: its parts mark the stencil, and what is a little larger is drawn beside the mark. It is seen
    // through other links, as the axes are.
    outline(node) {
      const width = OUTLINE * this.lines * this.reach;
      const line = () => new THREE.MeshBasicMaterial({
        color: styled("outline"), side: THREE.BackSide, depthTest: false, depthWrite: false, transparent: true,
        stencilWrite: true, stencilFunc: THREE.NotEqualStencilFunc, stencilRef: MARKED,
      });
      const [plain, grown] = [line(), line()];
      grown.onBeforeCompile = (shader) => {
        shader.uniforms.width = { value: width };
        const [begin, project] = ["#include <common>", "#include <project_vertex>"];
        shader.vertexShader = shader.vertexShader
          .replace(begin, `uniform float width;\n${begin}`)
          .replace(project, `${project}\nmvPosition.xyz += width * normalize(normalMatrix * normal);\ngl_Position = projectionMatrix * mvPosition;`);
      };
      const parts = [];
      node.traverse((part) => part.isMesh && part.userData.layer === "links" && parts.push(part));
      for (const part of parts) {
        Object.assign(part.material, { stencilWrite: true, stencilRef: MARKED, stencilZPass: THREE.ReplaceStencilOp, stencilZFail: THREE.ReplaceStencilOp });
        const simple = Object.values(this.geometries).includes(part.geometry); // else each corner moves along its normal
        const around = new THREE.Mesh(part.geometry, simple ? plain : grown);
        around.matrixAutoUpdate = false;
        around.matrix.copy(part.matrix);
        const size = part.geometry.boundingBox.getSize(new THREE.Vector3()).multiply(new THREE.Vector3().setFromMatrixScale(part.matrix));
        if (simple) around.matrix.scale(new THREE.Vector3(...size.toArray().map((side) => 1 + (2 * width) / side)));
        around.visible = part.visible;
        around.renderOrder = 2; // once all links have marked
        around.userData = { layer: "links", outline: true, shared: true };
        part.parent.add(around);
      }
    },

    // The link and the frame of a row stand out, or the node of a name; null for none.
    highlight(row, link = null) {
      this.row = row;
      this.link = link;
      const lines = [];
      this.arm.traverse((object) => {
        if (object.userData.outline) lines.push(object);
        else if (object.material?.stencilWrite) object.material.stencilWrite = false;
      });
      for (const line of lines) line.removeFromParent();
      this.worn.push(...new Set(lines.map((line) => line.material)));
      for (const tube of this.strokes.children) this.emphasise(tube);
      for (const node of this.nodes) {
        const on = link === null ? row !== null && node.userData.row === row : node.name === link;
        node.traverse((object) => {
          if (object.isMesh && object.userData.layer === "frames") {
            object.material.opacity = (row === null && link === null) || on ? 1 : 0.35;
          } else if (object.userData.element) {
            object.userData.element.classList.toggle("arm-view-picked", on);
            delete object.userData.size; // it is bold now, or no longer
          }
        });
        if (on) this.outline(node);
      }
      this.draw();
    },

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
      return points.every((point) => point.project(this.camera).toArray().every((part) => Math.abs(part) <= 1));
    },

    // The camera where it sees all of the arm, and is no farther away than that needs; from where it looks now, if it is
    // to keep its direction.
    fit(keep = false) {
      const seen = this.camera.position.clone().sub(this.controls.target).normalize();
      const away = keep && seen.lengthSq() ? seen : FROM, right = new THREE.Vector3().crossVectors(this.camera.up, away).normalize();
      const up = new THREE.Vector3().crossVectors(away, right);
      // A camera at c sees p where |(p - c)·right| <= t (c - p)·away, and so for up: for each of the two directions two
      // planes, which the outermost points push away. The nearest c that satisfies all of them is to be had at once.
      const points = this.points();
      let distance = -Infinity;
      const sides = this.margins(right, up).map(([direction, slope]) => {
        const [one, other] = [1, -1].map((sign) => Math.max(...points.map((p) => sign * p.dot(direction) + slope * p.dot(away))));
        distance = Math.max(distance, (one + other) / (2 * slope));
        return direction.clone().multiplyScalar((one - other) / 2);
      });
      const depth = points.reduce((sum, p) => sum + p.dot(away), 0) / points.length;
      distance = Math.max(distance, depth + 0.3 * this.reach); // of a robot that is a point
      this.controls.target.copy(sides[0]).add(sides[1]).addScaledVector(away, depth);
      this.camera.position.copy(sides[0]).add(sides[1]).addScaledVector(away, distance);
      this.camera.near = 0.005 * this.reach;
      this.camera.far = 20 * (distance - depth + this.reach);
      this.camera.updateProjectionMatrix();
      this.controls.update();
      this.own = false;
      this.fitted = this.reach;
      this.grid(this.reach);
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

    // The ray from the camera through the pointer.
    ray(event) {
      const canvas = event.currentTarget.getBoundingClientRect();
      const caster = new THREE.Raycaster();
      const x = (2 * (event.clientX - canvas.left)) / canvas.width - 1;
      const y = 1 - (2 * (event.clientY - canvas.top)) / canvas.height;
      caster.setFromCamera(new THREE.Vector2(x, y), this.camera);
      return caster;
    },

    // The scene as it is on the screen, twice as fine, as a file; without the ground, if that is to be transparent.
    savePicture(name, transparent) {
      const fine = 2;
      this.renderer.setPixelRatio(fine);
      const sheet = this.pictured(fine, transparent);
      this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      this.draw();
      const link = document.createElement("a");
      link.download = `${name}.png`;
      link.href = sheet.toDataURL("image/png");
      link.click();
    },

    // The scene with its labels, on a canvas of so many pixels for one of the screen.
    pictured(fine, transparent) {
      const { clientWidth: width, clientHeight: height } = this.$el;
      const sheet = document.createElement("canvas");
      [sheet.width, sheet.height] = [Math.round(fine * width), Math.round(fine * height)];
      const pen = sheet.getContext("2d");
      this.ground.visible = !transparent;
      this.renderer.render(this.scene, this.camera);
      if (!transparent) {
        pen.fillStyle = styled("paper");
        pen.fillRect(0, 0, sheet.width, sheet.height);
      }
      pen.drawImage(this.renderer.domElement, 0, 0, sheet.width, sheet.height);
      this.ground.visible = true;
      pen.scale(sheet.width / width, sheet.height / height);
      pen.textBaseline = "middle";
      const origin = this.$el.getBoundingClientRect();
      for (const label of this.sheet.children) {
        const style = getComputedStyle(label), box = label.getBoundingClientRect();
        if (style.visibility === "hidden") continue;
        const [x, y] = [box.left - origin.left, box.top - origin.top];
        pen.fillStyle = style.backgroundColor;
        pen.fillRect(x, y, box.width, box.height);
        pen.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
        pen.fillStyle = style.color;
        pen.fillText(label.textContent, x + parseFloat(style.paddingLeft), y + box.height / 2);
      }
      return sheet;
    },

    // A frame of a turn of the camera about the arm, as a data address: from where it looks now, a share of the turn on,
    // with a longer side of at most so many pixels. After the last one null ends the turn, and the camera is back.
    turn(share, largest) {
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
          for (const point of points) distance = Math.max(distance, Math.abs(point.dot(direction)) / slope + point.dot(away));
      }
      return { middle, distance };
    },

    // Directions of the picture, each with the slope of the rays at its margin.
    margins(right, up) {
      const { clientWidth: width, clientHeight: height } = this.$el;
      const tall = Math.tan((this.camera.fov * Math.PI) / 360), wide = tall * this.camera.aspect;
      return [[right, wide * (1 - (2 * MARGIN) / (width || 1e3))], [up, tall * (1 - (2 * MARGIN) / (height || 1e3))]];
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

    // --- The handle: dragged in the plane that faces the camera, it says where tool0 is wanted. One place at a time is
    // on its way; the newest follows when that one has been answered. ---

    showHandle(shown) {
      this.handle.visible = shown;
      this.draw();
    },

    take(event) {
      if (!this.handle.visible || event.button !== 0) return;
      const caster = this.ray(event);
      if (!caster.intersectObject(this.handle).length) return;
      const facing = this.camera.getWorldDirection(new THREE.Vector3());
      this.plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, this.handle.position);
      this.grip = caster.ray.intersectPlane(this.plane, new THREE.Vector3()).sub(this.handle.position);
      this.begins = true;
      this.controls.enabled = false;
      event.currentTarget.setPointerCapture(event.pointerId);
    },

    drag(event) {
      if (!this.plane) return;
      const place = this.ray(event).ray.intersectPlane(this.plane, new THREE.Vector3());
      if (!place) return;
      this.wanted = place.sub(this.grip).toArray();
      this.aim();
    },

    aim() {
      if (this.asked || !this.wanted) return;
      this.asked = true;
      this.$emit("aim", { place: this.wanted, begins: this.begins });
      this.wanted = null;
      this.begins = false;
    },

    aimed() {
      this.asked = false;
      this.aim();
    },

    release() {
      this.plane = null;
      this.controls.enabled = true;
    },

    pick(event) {
      const shown = this.nodes.filter((node) => node.visible);
      const hit = this.ray(event).intersectObjects(shown, true).find(({ object }) => object.visible && object.isMesh);
      let node = hit?.object;
      while (node && node.userData.row === undefined) node = node.parent;
      this.$emit("pick", { row: node?.userData.row ?? null, node: node?.name ?? null });
    },

    // The camera by keyboard: arrows turn it about what it looks at, + and - move it, 0 sees all.
    key(event) {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      const nearer = { "+": 0.85, "=": 0.85, "-": 1 / 0.85 }[event.key];
      if (!turns && !nearer && event.key !== "0" && !KEYS[event.key]) return;
      event.preventDefault();
      if (KEYS[event.key]) return this.look(KEYS[event.key]);
      if (event.key === "0") return this.fit(true);
      const { target } = this.controls, away = this.camera.position.clone().sub(target);
      const z = new THREE.Vector3(0, 0, 1);
      if (turns) {
        const polar = Math.min(Math.max(away.angleTo(z) + turns[1] * STEP, 0.05), Math.PI - 0.05);
        away.applyAxisAngle(z, turns[0] * STEP);
        const side = new THREE.Vector3().crossVectors(z, away).normalize();
        away.applyAxisAngle(side, polar - away.angleTo(z));
      } else away.multiplyScalar(nearer);
      this.camera.position.copy(target).add(away);
      this.controls.update();
      this.own = !this.seen();
      this.draw();
    },

    resize() {
      const { clientWidth: width, clientHeight: height } = this.$el;
      if (!width || !height) return;
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      this.renderer?.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      this.renderer?.setSize(width, height);
      if (!this.own) this.fit(true);
      this.draw();
    },

    draw() {
      if (this.pending) return;
      this.pending = true;
      requestAnimationFrame(() => {
        this.pending = false;
        this.scene.updateMatrixWorld();
        this.renderer?.render(this.scene, this.camera);
        for (const held of this.worn.splice(0)) held.dispose();
        this.cube.turn(this.camera);
        this.place();
        this.$el.drawn = (this.$el.drawn ?? 0) + 1;
      });
    },
  },
};
