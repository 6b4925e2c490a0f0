// The axes of the world in a corner of the picture, as the camera sees them.
import { THREE } from "nicegui-scene";
import { AXES } from "dh2urdf-scene/shapes.js";

const ARM = 22; // length of an axis that lies in the picture [px]
const NAMES = ["x", "y", "z"];

export const axisCross = {
  cross() {
    const sheet = this.$el.querySelector(".arm-view-cross");
    const turned = this.camera.quaternion.clone().invert();
    const axes = AXES.map(([colour, direction], number) => ({ colour, name: NAMES[number], tip: direction.clone().applyQuaternion(turned) }));
    axes.sort((one, other) => one.tip.z - other.tip.z); // the nearest one is drawn last
    const number = (x) => (ARM * x).toFixed(2);
    sheet.innerHTML = axes
      .map(({ colour, name, tip: { x, y } }) => {
        const paint = `#${new THREE.Color(colour).getHexString()}`;
        return `<g data-axis="${name}"><line x2="${number(x)}" y2="${number(-y)}" stroke="${paint}"/><circle cx="${number(1.3 * x)}" cy="${number(-1.3 * y)}" r="6.5" fill="${paint}"/><text x="${number(1.3 * x)}" y="${number(-1.3 * y)}">${name}</text></g>`;
      })
      .join("");
  },
};
