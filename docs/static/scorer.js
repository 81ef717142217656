// The order of what a search finds: pages that help to do a thing first, those that mention everything last.
const ORDER = [
  [/^developer\/changes/, 0.2],
  [/^developer\//, 0.4],
  [/^(gallery|performance\/|validation\/)/, 0.6],
  [/^(glossary|reference\/keys|how-to\/)/, 1.3],
];

var Scorer = {
  score: ([docname, title, anchor, descr, score]) =>
    score * (ORDER.find(([pages]) => pages.test(docname)) || [null, 1.0])[1],
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
