// The line around a picked link.
import { THREE } from "nicegui-scene";
import { styled } from "dh2urdf-scene/shapes.js";

const OUTLINE = 0.0045; // width of the line around a picked link, in reaches of the arm
const MARKED = 1; // what the stencil holds where the picked link is

export const outlines = {
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

  isPicked(node) {
    return this.link === null ? this.row !== null && node.userData.row === this.row : node.name === this.link;
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
    this.pickedAt = this.picked();
    for (const node of this.nodes) {
      const on = this.isPicked(node);
      node.traverse((object) => {
        if (object.isMesh && object.userData.layer === "frames") {
          object.material.opacity = (row === null && link === null) || on ? 1 : 0.35;
        } else if (object.userData.element) {
          object.userData.element.classList.toggle("arm-view-picked", on);
          delete object.userData.size; // it is bold now, or no longer
        }
      });
      if (on && this.layers.has("outlines")) this.outline(node);
    }
    this.draw();
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
    this.renderer.render(this.scene, this.eye());
    this.rehearsed.removeFromParent();
  },
};
