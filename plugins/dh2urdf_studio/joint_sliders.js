// A slider and a number for every joint. While one is dragged, the next values are sent when the ones before have been
// answered, so that a slow machine falls behind by one step and not by many.
const DECIMAL = /^[+-]?(\d+\.?\d*|\.\d+)$/; // in JavaScript 0x10 is a number, too: to a cell it is none

export default {
  template: `
    <div class="joint-sliders" :aria-busy="busy">
      <template v-for="(joint, index) in joints" :key="joint.name">
      <button v-if="folds && joint.group !== joints[index - 1]?.group" type="button" class="joint-sliders-fold"
              :aria-expanded="!folded[joint.group]" @click="folded[joint.group] = !folded[joint.group]">{{ folded[joint.group] ? "▸" : "▾" }} {{ joint.group }}</button>
      <label v-show="!folds || !folded[joint.group]" class="joint-slider" :title="limits(joint)">
        <span class="joint-slider-name">{{ folds ? joint.name.slice(joint.group.length + 1) : joint.name }}</span>
        <input type="range" step="any" :min="joint.lower" :max="joint.upper" :value="values[index]"
               :aria-label="joint.name" :aria-valuetext="text(index) + ' ' + joint.unit"
               @input="set(index, $event.target.valueAsNumber)" @keydown="step(index, $event)" />
        <input type="text" inputmode="decimal" class="joint-slider-number" :value="typed[index] ?? text(index)"
               :aria-label="joint.name + ' in ' + joint.unit" :aria-invalid="refused === index" :title="refused === index ? why : ''"
               @input="typed[index] = $event.target.value" @change="enter(index, $event.target.value)" @blur="leave(index)" />
        <span class="joint-slider-unit">{{ joint.unit }}</span>
      </label>
      </template>
    </div>`,

  // folded: robots whose sliders are folded away, where there are several; typed: numbers that are not finished yet; busy: values are sent and not answered yet; refused: which box holds
  // something that is no joint value, and why
  data: () => ({ joints: [], values: [], folded: {}, typed: {}, busy: false, refused: null, why: "" }),

  computed: {
    folds() {
      return new Set(this.joints.map(({ group }) => group)).size > 1;
    },
  },

  created() {
    this.pending = false;
    this.number = 0; // of the values that were sent last
  },

  methods: {
    // Where only limits are others, what is being typed stays, and so do values that are not answered yet.
    show(joints, values) {
      const named = (all) => all.map(({ name, unit }) => `${name} ${unit}`).join();
      const isSame = named(joints) === named(this.joints);
      this.joints = joints;
      if (isSame && this.busy) return;
      this.values = values;
      if (isSame) return;
      this.typed = {};
      this.busy = this.pending = false;
    },

    limits({ name, lower, upper, unit, digits }) {
      const [least, most] = [lower, upper].map((value) => Number(value.toFixed(digits)));
      return `${name}: ${least} to ${most} ${unit}`;
    },

    // The values that hold now; the number is that of the last ones that the server has seen.
    answer(values, number) {
      if (number < this.number) return; // newer ones are on their way
      this.busy = false;
      if (this.pending) this.send();
      else this.values = values;
    },

    // A number is taken here; what else a cell takes, such as pi/2 or 90°, the server reads.
    enter(index, text) {
      this.refused = null;
      if (DECIMAL.test(text.trim())) this.take(index, Number(text));
      else if (text.trim()) this.$emit("typed", { index, text });
      else delete this.typed[index];
    },

    // A number that was typed again as it was is no change to the browser; the box goes on following the joint.
    leave(index) {
      if (this.refused !== index) delete this.typed[index];
    },

    take(index, value) {
      delete this.typed[index];
      this.set(index, value);
    },

    refuse(index, why) {
      this.refused = index;
      this.why = why;
    },

    set(index, value) {
      const { lower, upper } = this.joints[index];
      this.values[index] = Number.isFinite(value) ? Math.min(Math.max(value, lower), upper) : this.values[index];
      this.values = [...this.values];
      this.send();
    },

    step(index, event) {
      const sign = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (!sign) return;
      event.preventDefault();
      const { step } = this.joints[index];
      this.set(index, this.values[index] + sign * step * (event.shiftKey ? 10 : 1));
    },

    send() {
      this.pending = this.busy;
      if (this.busy) return;
      this.busy = true;
      this.number += 1;
      this.$emit("values", { values: [...this.values], number: this.number });
    },

    text(index) {
      return String(Number(this.values[index].toFixed(this.joints[index].digits)));
    },
  },
};
