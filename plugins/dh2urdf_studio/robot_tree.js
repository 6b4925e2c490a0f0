// Robots, their links, and what these consist of: a tree as WAI-ARIA has it, one tab stop whose items the arrow keys reach.
// Enter picks a link, Space hides and shows it.
export default {
  template: `
    <div class="robot-tree" role="tree" aria-label="Robots">
      <div v-for="item in items" :key="item.key" :data-key="item.key" role="treeitem" class="robot-tree-item"
           :class="['robot-tree-' + item.kind, { 'robot-tree-hidden': item.shown === false }]"
           :style="{ paddingLeft: 14 * (item.level - 1) + 'px' }" :title="item.text"
           :aria-level="item.level" :aria-setsize="item.count" :aria-posinset="item.number"
           :aria-expanded="item.open" :aria-checked="item.shown" :aria-selected="item.kind === 'link' ? item.node === picked : undefined"
           :tabindex="item.key === current ? 0 : -1" @click="press(item)" @keydown="key(item, $event)" @focus="current = item.key">
        <span class="robot-tree-fold" aria-hidden="true" :data-mark="item.open === undefined ? '' : item.open ? '▾' : '▸'" @click.stop="fold(item)"></span>
        <span v-if="item.shown !== undefined" class="robot-tree-eye material-icons" aria-hidden="true" :data-mark="item.shown === false ? 'visibility_off' : 'visibility'" @click.stop="hide(item)"></span>
        <b v-if="item.level === 3">{{ item.kind }}&nbsp;</b><span class="robot-tree-text">{{ item.text }}</span>
      </div>
    </div>`,

  // open: keys of what is unfolded; hidden: nodes; picked: a node; current: the key of the item that Tab reaches
  data: () => ({ robots: [], open: {}, hidden: {}, picked: null, current: null }),

  computed: {
    // The items that are in sight, in order.
    items() {
      const found = [];
      this.robots.forEach((robot, number) => {
        const key = `r${number}`, open = !!this.open[key];
        const hidden = robot.links.filter(({ node }) => this.hidden[node]).length;
        const shown = hidden === 0 ? true : hidden === robot.links.length ? false : "mixed";
        found.push({ key, kind: "robot", level: 1, text: `${robot.name} (${robot.links.length})`, open, shown, robot, number: number + 1, count: this.robots.length });
        if (open) robot.links.forEach((link, place) => this.link(found, robot, link, place, key));
      });
      return found;
    },
  },

  methods: {
    link(found, robot, { node, name, items }, place, above) {
      const key = `l${node}`, open = !!this.open[key];
      found.push({ key, kind: "link", level: 2, text: name, open, shown: !this.hidden[node], node, above, number: place + 1, count: robot.links.length });
      if (open)
        items.forEach(({ kind, text }, index) =>
          found.push({ key: `${key}/${index}`, kind, level: 3, text, node, above: key, number: index + 1, count: items.length }));
    },

    // Other robots; those of a scene of one are unfolded.
    show(robots, hidden) {
      this.robots = robots;
      this.hidden = Object.fromEntries(hidden.map((node) => [node, true]));
      if (robots.length === 1) this.open.r0 = true;
      this.current ??= "r0";
    },

    // A link stands out, and is in sight; null for none.
    choose(node) {
      this.picked = node;
      const number = this.robots.findIndex((robot) => robot.links.some((link) => link.node === node));
      if (number < 0) return;
      this.open[`r${number}`] = true;
      this.current = `l${node}`;
      this.$nextTick(() => this.element(this.current)?.scrollIntoView({ block: "nearest" }));
    },

    press(item) {
      if (item.kind === "robot") this.fold(item);
      else this.pick(item.node);
    },

    pick(node) {
      this.picked = node === this.picked ? null : node;
      this.$emit("pick", { node: this.picked });
    },

    fold(item) {
      if (item.open === undefined) return this.press(item);
      this.open[item.key] = !item.open;
    },

    hide(item) {
      const nodes = item.robot ? item.robot.links.map(({ node }) => node) : [item.node];
      const hides = item.shown === true;
      for (const node of nodes) this.hidden[node] = hides;
      this.$emit("hide", { nodes: Object.keys(this.hidden).filter((node) => this.hidden[node]) });
    },

    key(item, event) {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const index = this.items.indexOf(item), last = this.items.length - 1;
      const to = { ArrowDown: Math.min(index + 1, last), ArrowUp: Math.max(index - 1, 0), Home: 0, End: last }[event.key];
      if (to !== undefined) this.reach(this.items[to].key);
      else if (event.key === "ArrowRight" && item.open === false) this.fold(item);
      else if (event.key === "ArrowRight" && item.open) this.reach(this.items[Math.min(index + 1, last)].key);
      else if (event.key === "ArrowLeft" && item.open) this.fold(item);
      else if (event.key === "ArrowLeft" && item.above) this.reach(item.above);
      else if (event.key === "Enter") this.press(item);
      else if (event.key === " " && item.shown !== undefined) this.hide(item);
      else if (!event.key.startsWith("Arrow") && event.key !== " ") return;
      event.preventDefault();
    },

    reach(key) {
      this.current = key;
      this.element(key)?.focus();
    },

    element(key) {
      return [...this.$el.children].find((child) => child.dataset.key === key);
    },
  },
};
