/** Adds all tools. */
import { byId } from '../dom';
import type { ToolContext } from './context';
import { coverageTool } from './coverage';
import { exportTool } from './export';
import { importTool } from './import';
import { measureTool } from './measure';
import { pathTool } from './path';
import type { Toolbox } from './toolbox';
import type { Comparison } from './weave/comparison';
import { weaveTool } from './weave/weave';

/** @param importing called to open the import, which needs no map, from the list of sessions */
export function addTools(toolbox: Toolbox, context: ToolContext, comparison: Comparison, importing: () => void): void {
  const bringIn = importTool();
  toolbox.add(measureTool(context.map, context.target, context.theme));
  toolbox.add(pathTool(context));
  toolbox.add(coverageTool(context));
  toolbox.add(weaveTool(context, comparison));
  toolbox.add(bringIn);
  toolbox.add(exportTool(context));
  byId('import-open', HTMLButtonElement).addEventListener('click', () => {
    importing();
    toolbox.toggle(bringIn);
  });
}
