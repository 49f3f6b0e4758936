// SPDX-License-Identifier: Apache-2.0
// plots.js alone uses the library; its own types are in the npm package.
declare const uPlot: any;
export default uPlot;
