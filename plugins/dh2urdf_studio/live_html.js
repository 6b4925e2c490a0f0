// HTML that follows every letter and every slider. It is a component with a state of its own: a property of an element
// would have Vue go through all elements of the page, which takes longer than the rest of an edit.
export default {
  template: `<div v-html="content"></div>`,
  data: () => ({ content: "" }),
  methods: {
    show(content) {
      this.content = content;
    },
  },
};
