-- The language server of G7 in Neovim (0.8 or newer): problems as you type, fixes, completion, names.
local M = {}

-- A command of a code lens: [uri, name]. Run, test and prove go to a terminal, draw to the browser.
local function command(work)
  return function(what)
    local uri, name = unpack(what.arguments or {})
    local file = vim.uri_to_fname(uri)
    local program = vim.g.g7_program or 'g7'
    local args = { program, work, file }
    if work == 'test' and name then
      args = { program, 'test', file, '--filter', name }
    elseif work == 'draw' then
      args = { program, 'serve', vim.fn.fnamemodify(file, ':h'), '--start', vim.fn.fnamemodify(file, ':t') }
    end
    vim.cmd('botright new')
    vim.fn.termopen(args)
  end
end

function M.start()
  if not vim.lsp.start then
    return
  end
  local program = vim.g.g7_program or 'g7'
  local here = vim.api.nvim_buf_get_name(0)
  for _, work in ipairs({ 'run', 'test', 'prove', 'draw' }) do
    vim.lsp.commands['g7.' .. work] = command(work)
  end
  vim.lsp.start({
    name = 'g7',
    cmd = { program, 'lsp' },
    root_dir = vim.fs.dirname(vim.fs.find({ '.git' }, { upward = true, path = here })[1] or here),
  })
end

return M
