-- The language server of G7 in Neovim (0.7 or newer): problems as you type, fixes, completion, names.
local M = {}

local function program()
  return vim.g.g7_program or 'g7'
end

-- A command of a code lens, with the address of the file and a name; it is carried out in a terminal.
local function command(work)
  return function(what)
    local arguments = what.arguments or {}
    local file, name = vim.uri_to_fname(arguments[1]), arguments[2]
    local line = { program(), work, file }
    if work == 'test' and name and name ~= '' then
      line = { program(), 'test', file, '--filter', name }
    elseif work == 'draw' then
      line = { program(), 'serve', file }
    end
    vim.cmd('botright new')
    vim.fn.termopen(line)
  end
end

-- Starts the server for the current buffer; buffers of one folder share a server.
function M.start()
  for _, work in ipairs({ 'run', 'test', 'prove', 'draw' }) do
    vim.lsp.commands['g7.' .. work] = command(work)
  end
  local root = vim.fn.fnamemodify(vim.api.nvim_buf_get_name(0), ':p:h')
  local settings = { name = 'g7', cmd = { program(), 'lsp' }, root_dir = root }
  if vim.lsp.start then
    vim.lsp.start(settings)
    return
  end
  M.clients = M.clients or {}
  M.clients[root] = M.clients[root] or vim.lsp.start_client(settings)
  vim.lsp.buf_attach_client(0, M.clients[root])
end

return M
