// Formulas in the names of variables, as fmi/formula.py parses them.

const FUNCTIONS = {
  "+": (a, b) => a + b, "-": (a, b) => a - b, "*": (a, b) => a * b, "/": (a, b) => a / b,
  "**": (a, b) => a ** b, negative: (a) => -a, abs: Math.abs, sqrt: Math.sqrt, sin: Math.sin,
  cos: Math.cos, tan: Math.tan, sinh: Math.sinh, cosh: Math.cosh, tanh: Math.tanh, exp: Math.exp,
  log: Math.log, atan2: Math.atan2, hypot: Math.hypot,
};

// A formula, [operation, operand, ...], as a function of the values of its variables by name.
function formula(tree) {
  if (typeof tree === "string") return (values) => values[tree];
  if (!Array.isArray(tree)) return () => tree;
  const apply = FUNCTIONS[tree[0]], [one, two] = tree.slice(1).map(formula);
  return two ? (values) => apply(one(values), two(values)) : (values) => apply(one(values));
}
