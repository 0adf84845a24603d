// SPDX-License-Identifier: BSD-3-Clause
// All charts, one below the other.
import { Chart } from "./chart";
import { addChart, charts } from "./layout";
import { LayoutFile } from "./layout_file";

export function Charts() {
  return (
    <div class="charts">
      {charts.value.map((one) => <Chart key={one.id} layout={one} />)}
      <div class="tools">
        <button type="button" class="add" onClick={() => addChart()}>add a chart</button>
        <LayoutFile />
      </div>
    </div>
  );
}
