// The scene as a file.
import { THREE } from "nicegui-scene";
import { styled } from "dh2urdf-scene/shapes.js";

export const pictures = {
  // The scene as it is on the screen, twice as fine, as a file; without the ground, if that is to be transparent.
  savePicture(name, transparent) {
    const fine = 2;
    this.arrive();
    const sharp = this.isSmooth ? fine : 2 * fine; // what is drawn finer is smooth when it gets smaller
    this.renderer.setPixelRatio(sharp);
    const { drawingBufferWidth, drawingBufferHeight } = this.renderer.getContext(), { width, height } = this.renderer.domElement;
    const given = Math.min(drawingBufferWidth / width, drawingBufferHeight / height); // browsers give less than is too much
    if (given < 1) this.renderer.setPixelRatio(sharp * given);
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
    this.renderer.render(this.scene, this.eye());
    if (!transparent) {
      pen.fillStyle = styled("paper");
      pen.fillRect(0, 0, sheet.width, sheet.height);
    }
    pen.drawImage(this.renderer.domElement, 0, 0, sheet.width, sheet.height);
    this.ground.visible = true;
    pen.scale(sheet.width / width, sheet.height / height);
    pen.textBaseline = "middle";
    pen.strokeStyle = styled("soft");
    pen.stroke(new Path2D(this.leaders));
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
};
